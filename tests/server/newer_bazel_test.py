#!/usr/bin/env python3
"""Bazel 7.7 with kiln-cached as its remote cache. Its 600 MB are fetched only on demand: KILN_PEERS_BAZEL=yes or tools/peers.sh --bazel.

usage: newer_bazel_test.py KILN_CACHED [TEST...]
"""
import os

from bazel import hits_and_poison
from cached import main, skip
from peers import Peers, has_bazel

peers = None


def http(binary):
    hits_and_poison(binary, peers.inside("bazel"), "http", "--noenable_bzlmod", "--enable_workspace")


def grpc(binary):
    hits_and_poison(binary, peers.inside("bazel"), "grpc", "--noenable_bzlmod", "--enable_workspace")


if __name__ == "__main__":
    if not has_bazel() and os.environ.get("KILN_PEERS_BAZEL") != "yes":
        skip("Bazel 7.7 is not unpacked (tools/peers.sh --bazel)")
    peers = Peers(bazel=True)
    main([http, grpc])
