# Steps that .ci/run and scripts/nightly consist of; both source this file. Each goes on after a failure, so that one run
# names them all. Logs are in $logs.
failed=()

# check NAME COMMAND...: runs a step with its output in $logs/NAME.log, the end of which is shown only if it fails.
check() {
  local name=$1 log=$logs/$1.log start=$SECONDS
  shift
  if "$@" >"$log" 2>&1 </dev/null; then
    printf '%-10s ok      %4d s\n' "$name" $((SECONDS - start))
  else
    printf '%-10s FAILED  %4d s\n' "$name" $((SECONDS - start))
    tail -n 150 "$log"
    failed+=("$name")
  fi
}

# Exits with 1 if a step failed, after a line that names all that did.
finish() {
  ((${#failed[@]})) || exit 0
  echo "failed: ${failed[*]}"
  exit 1
}
