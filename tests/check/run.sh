#!/bin/sh
# Runs the checks named, or all of this folder, $JOBS at a time (2), and counts what they print. `make check` calls it.
set -u
cd "$(dirname "$0")/../.." || exit 1
logs=build/check
mkdir -p "$logs" && rm -f "$logs"/*.log
if [ $# = 0 ]; then
    set -- sanitize # the longest first
    for script in tests/check/*.sh; do
        case $script in */run.sh | */common.sh | */sanitize.sh) ;; *) set -- "$@" "$(basename "$script" .sh)" ;; esac
    done
fi
# Whatever happens to a check, it leaves a line: none at all, or a bad exit, is a failure.
printf '%s\n' "$@" | xargs -n 1 -P "${JOBS:-2}" sh -c '
    log=build/check/$0.log
    sh "tests/check/$0.sh" >"$log" 2>&1 </dev/null || grep -q "^FAILED " "$log" ||
        echo "FAILED $0: the check itself ended with $?" >>"$log"
    grep -qE "^(ok|FAILED|skip) " "$log" || echo "FAILED $0: it looked at nothing" >>"$log"
    cat "$log"'
passed=$(cat "$logs"/*.log | grep -c '^ok ')
failed=$(cat "$logs"/*.log | grep -c '^FAILED ')
echo "$passed passed, $failed failed"
[ "$failed" = 0 ]
