# The table of contents at the top of yarncloth.h is true: its tags are the chapter banners ` * >>name   (chapter N)`,
# each once and in the same order, with the same numbers.
. tests/check/common.sh

awk '
    /^ \* CONTENTS/ { inside = 1 }
    inside && /^ \*\// { inside = 0 }
    inside && /^ \*   >>/ {
        number = "-"
        if (match($0, /chapter [0-9]+/)) number = substr($0, RSTART + 8, RLENGTH - 8)
        print $2, number
    }
' yarncloth.h >"$work/listed"
awk '
    /^ \* >>/ {
        number = "-"
        if (match($0, /\(chapter [0-9]+\)/)) number = substr($0, RSTART + 9, RLENGTH - 10)
        print $2, number
    }
' yarncloth.h >"$work/banners"

{
    [ -s "$work/listed" ] || echo "no tag listed under CONTENTS"
    cut -d ' ' -f 1 "$work/listed" | sort | uniq -d | sed 's/$/ is listed twice/'
    cut -d ' ' -f 1 "$work/banners" | sort | uniq -d | sed 's/$/ has two banners/'
    awk 'NR == FNR { listed[$1]; next } !($1 in listed) { print $1 " has a banner and is not listed" }' "$work/listed" "$work/banners"
    awk 'NR == FNR { banner[$1]; next } !($1 in banner) { print $1 " is listed and has no banner" }' "$work/banners" "$work/listed"
} >"$work/complaints"
[ -s "$work/complaints" ] || diff "$work/listed" "$work/banners" |
    sed -n 's/^< \(.*\)/order or number: listed as \1/p; s/^> \(.*\)/order or number: banner of \1/p' >"$work/complaints"
verdict contents "$work/complaints"
