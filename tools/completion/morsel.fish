# SPDX-License-Identifier: Apache-2.0
# Completion of the command morsel for fish. What is completed is what `--help` says.
function __morsel_help
    set -l words (commandline -opc)
    set -l path
    for word in $words[2..-1]
        string match -qr '^[a-z]+$' -- $word; or break
        set -a path $word
        test (count $path) -ge 2; and break
    end
    $words[1] $path --help 2>/dev/null; or $words[1] $path[1] --help 2>/dev/null
end
complete -c morsel -n 'string match -q -- "-*" (commandline -ct)' -f -a '(__morsel_help | string match -ar -- "--?[a-z][a-z-]*" | sort -u)'
complete -c morsel -n 'test (count (commandline -opc)) -le 2' -a '(__morsel_help | string replace -rf "^  ([a-z]+) +(.*)" "\$1\t\$2")'
