# SPDX-License-Identifier: Apache-2.0
# Completion of the command morsel for fish. What to offer is what `--help` says, as for bash.

function __morsel_offers
    set -l typed (commandline -opc)
    set -l word (commandline -ct)
    set -l program $typed[1]
    # The subcommand: the words before the first flag or file, at most two.
    set -l arguments
    for each in $typed[2..3]
        string match -qr '^[a-z]+$' -- $each; or break
        set -a arguments $each
    end
    set -l subcommands (count $arguments)
    # The longest part of it that the program knows.
    set -l help ($program $arguments --help 2>/dev/null)
    while test -z "$help" -a (count $arguments) -gt 0
        set -e arguments[-1]
        set help ($program $arguments --help 2>/dev/null)
    end

    set -l before $typed[-1]
    if string match -q -- '-*' $word
        printf '%s\n' $help | grep -oE '(^|[ ,])--?[a-z][a-z-]*' | tr -d ' ,' | sort -u
    else if string match -q -- '--*' $before
        # Choices stand in braces: --progress TEXT:{auto,bar,...}
        printf '%s\n' $help | grep -oE -- "$before [A-Z]+:\{[^}]*\}" | head -n 1 | sed 's/.*{//; s/}//' | tr ',' '\n'
    else if test $subcommands -eq (math (count $typed) - 1)
        # With what it does behind a tab.
        printf '%s\n' $help | sed -n '/^Subcommands:/,$ s/^  \([a-z][a-z]*\)  *\(.*\)/\1\t\2/p'
    end
end

complete -c morsel -a '(__morsel_offers)'
