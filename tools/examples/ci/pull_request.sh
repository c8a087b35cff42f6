#!/usr/bin/env bash
# The job of a pull request, whose code nobody has read yet: reads main through its own instance, and writes that alone.
set -euo pipefail
KILN_CACHE_TOKEN_FILE=$TOKEN_FILE \
  "${KILN:-kiln}" build "$1" -o "$2" --cache "$CACHE/pr/$PR" --report-json "$2.json"
