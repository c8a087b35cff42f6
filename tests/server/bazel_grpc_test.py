#!/usr/bin/env python3
"""Debian's Bazel with kiln-cached as its remote cache over gRPC. (By TLS this Bazel ends without a word; that is tests/unit/server_grpc.)

usage: bazel_grpc_test.py KILN_CACHED
"""
import shutil

from bazel import hits_and_poison
from cached import main, skip


def grpc(binary):
    hits_and_poison(binary, ["bazel"], "grpc")


if __name__ == "__main__":
    if not shutil.which("bazel"):
        skip("no bazel (Debian's bazel-bootstrap)")
    main([grpc])
