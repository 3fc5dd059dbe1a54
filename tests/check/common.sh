# Read by every check. A check prints one line for each thing it looks at: `ok name`, `FAILED name: reason` or, where a
# tool is missing, `skip name: reason`. With CHECK_STRICT=1 a missing tool is a failure. Checks run in the repository
# root and keep what they make in $work.

set -u
check=$(basename "$0" .sh)
work=build/check/$check
rm -rf "$work" && mkdir -p "$work" || exit 1
CC=${CC:-cc}
warnings='-Wall -Wextra -pedantic -Wconversion -Wshadow -Werror'

ok() { echo "ok $1"; }
failed() { echo "FAILED $1: $2"; }

# need TOOL NAME: ends the check where the tool is missing.
need() {
    command -v "$1" >/dev/null 2>&1 && return
    if [ "${CHECK_STRICT:-0}" = 1 ]; then failed "$2" "no $1 here"; else echo "skip $2: no $1 here"; fi
    exit 0
}

# verdict NAME FILE: ok when the file of complaints is empty, else the first of them and their number.
verdict() {
    if [ -s "$2" ]; then failed "$1" "$(head -n 1 "$2") ($(wc -l <"$2" | tr -d ' ') in $2)"; else ok "$1"; fi
}

# attempt NAME COMMAND...: ok when the command succeeds, else its first line with an error in it.
attempt() {
    attempt_name=$1 && shift
    attempt_log=$work/$(echo "$attempt_name" | tr -c 'A-Za-z0-9.\n' '_').log
    if "$@" >"$attempt_log" 2>&1 </dev/null; then ok "$attempt_name"; return 0; fi
    failed "$attempt_name" "$(grep -m 1 -E '^FAILED|error:|ERROR:|undefined reference|warning:' "$attempt_log" || tail -n 1 "$attempt_log") (all in $attempt_log)"
    return 1
}

# The repository's own files, one a line; no name holds a space.
files() { find . \( -name .git -o -path ./build -o -path ./out -o -path ./shared \) -prune -o -type f -print | sort; }
sources() { files | grep '\.[ch]$'; }

# The two lines that are the library's own unit.
implementation() { printf '%s\n' '#define YARNCLOTH_IMPLEMENTATION' '#include "yarncloth.h"'; }
