# Every mistake in tests/golden/bad: `expected` holds the exit code, then the place and severity of each diagnostic in order,
# with the line that says in which variants. Words are free to change; where and for whom are not.
. "$(dirname "$0")/common.inc"
for case in "$root"/tests/golden/bad/*/; do
  arguments=()
  if [ -f "$case/arguments" ]; then read -ra arguments <"$case/arguments"; fi
  code=0
  (cd "$case" && kiln build manifest.yaml -o "$t/bad.kiln" "${arguments[@]}" >"$t/out" 2>"$t/err") || code=$?
  {
    echo "$code"
    grep -oE '^([^ :]+:([0-9]+:[0-9]+:)?) (error|warning):|^ *in .* variants of .*' "$t/err" || true
  } >"$t/found"
  diff "$case/expected" "$t/found" || { cat "$t/err"; fail "$case"; }
  [ "$code" = 0 ] || [ ! -e "$t/bad.kiln" ] || fail "$case: a table was written"
  rm -f "$t/bad.kiln" "$t/bad.kiln.proof"
done
