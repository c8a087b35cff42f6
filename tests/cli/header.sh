# The key header packs at compile time what the runtime reader looks up.
. "$(dirname "$0")/common.inc"
small_project
kiln build p/m.yaml -o a.kiln --header key.h >/dev/null
grep -q constexpr key.h
for compiler in "g++ -std=c++17" "clang++ -std=c++17"; do
  echo '#include "key.h"' | $compiler -I. -Wall -Wextra -Werror -fsyntax-only -x c++ -
done
touch -d '2001-01-01' key.h
kiln build p/m.yaml -o a.kiln --header key.h >/dev/null
[ "$(stat -c %Y key.h)" -lt 1000000000 ] || fail "an unchanged header was touched"
