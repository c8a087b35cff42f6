#!/usr/bin/env bash
# The job of a branch, or a desk: reads what main's key signed, writes nothing. $SIGN_PUB: the public half, checked in.
set -euo pipefail
KILN_CACHE_TOKEN_FILE=$TOKEN_FILE KILN_CACHE_TRUST=$SIGN_PUB \
  "${KILN:-kiln}" build "$1" -o "$2" --cache "$CACHE/main" --cache-read-only --report-json "$2.json"
