#!/usr/bin/env bash
# The job of main: reads the cache, writes it, signs what it writes. $CACHE: the server; $TOKEN_FILE and $SIGN_KEY: secrets of this job.
set -euo pipefail
KILN_CACHE_TOKEN_FILE=$TOKEN_FILE KILN_CACHE_SIGN=$SIGN_KEY \
  "${KILN:-kiln}" build "$1" -o "$2" --cache "$CACHE/main" --report-json "$2.json"
