# Steps that .ci/run and scripts/nightly consist of; both source this file. Each goes on after a failure, so that one run
# names them all. Logs are in $logs.
failed=()

# check NAME BUDGET COMMAND...: runs a step with its output in $logs/NAME.log, the end of which is shown only if it fails.
# BUDGET is in seconds, from scratch on two idle cores. A step above it is marked; it fails at three times as much, which
# no noise of a machine explains.
check() {
  local name=$1 budget=$2 log=$logs/$1.log start=$SECONDS result=ok over=
  shift 2
  "$@" >"$log" 2>&1 </dev/null || result=FAILED
  local seconds=$((SECONDS - start))
  ((seconds <= budget)) || over="above its budget of $budget s"
  ((seconds <= 3 * budget)) || result=FAILED
  printf '%-10s %-7s %4d s  %s\n' "$name" $result $seconds "$over"
  if [[ $result == FAILED ]]; then
    tail -n 150 "$log"
    failed+=("$name")
  fi
}

# Exits with 1 if a step failed, after a line that names all that did.
finish() {
  echo "all steps: $SECONDS s"
  ((${#failed[@]})) || exit 0
  echo "failed: ${failed[*]}"
  exit 1
}
