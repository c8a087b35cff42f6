# Ctrl-C in the middle of a build leaves neither a table nor a temporary file, and the next build is whole.
. "$(dirname "$0")/common.inc"
for delay in 0.05 0.2 0.5; do
  "$KILN" build "$root/manifests/surface.yaml" -o s.kiln -j 1 >/dev/null 2>err &
  pid=$!
  sleep $delay
  kill -INT $pid 2>/dev/null || true
  wait $pid || true
  if [ -e s.kiln ]; then  # it was faster than the signal
    kiln dump s.kiln >/dev/null
    rm -f s.kiln s.kiln.proof
  fi
  [ -z "$(find . -maxdepth 1 -name '*.tmp.*')" ] || fail "a temporary file was left"
done
