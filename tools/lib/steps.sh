# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
# Named, timed steps for the scripts in tools/. Sourced, not run.
#
#   begin_step "Build"        prints the name and starts the clock
#   end_step "12 files"       prints how long it took, with an optional remark
#   print_times               one line with the time of every step
#
# A script that ends inside a step, by `set -e` or by `exit`, names that step and its time.

step_name=""
step_started=0
step_times=()
script_started=${EPOCHREALTIME//[.,]/}

# Prints the seconds since `$1` (microseconds of the clock) with one decimal.
seconds_since() {
  local tenths=$(((${EPOCHREALTIME//[.,]/} - $1) / 100000))
  echo "$((tenths / 10)).$((tenths % 10))"
}

begin_step() {
  step_name=$1
  step_started=${EPOCHREALTIME//[.,]/}
  printf '\n== %s\n' "$1"
}

end_step() {
  local seconds
  seconds=$(seconds_since "$step_started")
  printf '== %s: %s (%s s)\n' "$step_name" "${1:-done}" "$seconds"
  step_times+=("${step_name,,} $seconds s")
  step_name=""
}

print_times() {
  local list
  list=$(printf ', %s' "${step_times[@]}")
  printf '\nTime: %s; together %s s\n' "${list:2}" "$(seconds_since "$script_started")"
}

report_unfinished_step() {
  local status=$?
  if [[ -n $step_name && $status -ne 0 ]]; then
    printf '== %s: FAILED with exit code %d after %s s\n' "$step_name" "$status" \
      "$(seconds_since "$step_started")" >&2
  fi
}
trap report_unfinished_step EXIT

# run_logged LOG COMMAND...: the command's output goes to the file; on failure its last lines are
# shown and the command's exit code is returned.
run_logged() {
  local log=$1 status=0
  shift
  mkdir -p "$(dirname "$log")"
  "$@" >"$log" 2>&1 || status=$?
  if [[ $status -ne 0 ]]; then
    printf 'The last lines of %s:\n' "$log" >&2
    tail -n 25 "$log" >&2
  fi
  return "$status"
}
