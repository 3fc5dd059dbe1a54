# No file speaks of the machine or the circumstances it was written in. (The brackets keep this file out of its own
# net.)
. tests/check/common.sh

files | xargs grep -nIE '(^|[^A-Za-z0-9._~-])/(work|root|home|Users)/[A-Za-z0-9._]' >"$work/paths"
verdict words-no-machine-path "$work/paths"
files | xargs grep -nIE 'share[d]/' >"$work/folder"
verdict words-no-foreign-folder "$work/folder"
files | xargs grep -nIiE '(^|[^A-Za-z])is[s]ues?([^A-Za-z]|$)' >"$work/tracker"
verdict words-no-tracker "$work/tracker"
