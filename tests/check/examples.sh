# Every example builds.
. tests/check/common.sh
attempt examples make -s examples BUILD="$work/build"
