# Whatever happens to the cache, the table stays the same.
. "$(dirname "$0")/common.inc"
small_project
kiln build p/m.yaml -o a.kiln >/dev/null
python3 - "$XDG_CACHE_HOME" <<'PY'
import os, random, sys
random.seed(7)
files = sorted(os.path.join(d, f) for d, _, fs in os.walk(sys.argv[1]) for f in fs)
assert files
for i, path in enumerate(files):
    data = bytearray(open(path, "rb").read())
    if i % 3 == 0 and data:
        data[random.randrange(len(data))] ^= 1 << random.randrange(8)
    elif i % 3 == 1:
        data = data[: len(data) // 2]
    else:
        data = b""
    os.chmod(path, 0o644)
    open(path, "wb").write(data)
PY
kiln build p/m.yaml -o b.kiln >/dev/null
cmp a.kiln b.kiln
chmod -R a-w "$XDG_CACHE_HOME"
kiln build p/m.yaml -o c.kiln >/dev/null 2>&1
chmod -R u+w "$XDG_CACHE_HOME"
cmp a.kiln c.kiln
rm -rf "$XDG_CACHE_HOME"
echo "not a folder" >"$XDG_CACHE_HOME"
kiln build p/m.yaml -o d.kiln >/dev/null 2>err
cmp a.kiln d.kiln
grep -q warning err
