# Two folders with the same manifest share a cache and never answer for each other's sources.
. "$(dirname "$0")/common.inc"
small_project
cp -r p q
sed -i 's/c \*= 2.0/c *= 3.0/' q/paint.frag
kiln build p/m.yaml -o p.kiln >/dev/null
kiln build q/m.yaml -o q.kiln >/dev/null
! cmp -s p.kiln q.kiln || fail "q was answered with p's classes"
kiln build q/m.yaml -o q2.kiln --cache none >/dev/null
cmp q.kiln q2.kiln
