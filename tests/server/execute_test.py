#!/usr/bin/env python3
"""kiln build --execute on a fleet of buildbox-casd nodes whose central store and action cache is kiln-cached. $KILN names kiln.

usage: execute_test.py KILN_CACHED [TEST...]
"""
import contextlib
import json
import os
import pathlib
import shutil
import signal
import subprocess
import time

from cached import Cached, check, equal, main
from peers import ROOT, Daemon, Home, Peers, free_port

KILN = os.environ["KILN"]
REAL_WORKER = pathlib.Path(KILN).parent / "kiln-worker"
peers = None


class Node(Daemon):
    """A casd that runs one action at a time."""

    def __init__(self, central, home, name):
        port = free_port()
        self.url = f"grpc://127.0.0.1:{port}"
        shared = [f"--{which}-{what}" for which in ("cas", "ac") for what in (f"remote=http://{central}", "instance=main", "retry-limit=1")]
        super().__init__(peers.tool("buildbox-casd", f"--bind=127.0.0.1:{port}", *shared, "--jobs=1", "--quota-high=1G", "--reserved=1M",
                                    f"--buildbox-run={peers.folder}/bin/buildbox-run-hosttools", home / f"casd-{name}"), home, port)


class Fleet:
    """A home with a small manifest and its table as it is built here, a server, and room for nodes."""

    def __init__(self, binary):
        self.stack, self.binary = contextlib.ExitStack(), binary

    def __enter__(self):
        self.home = self.stack.enter_context(Home())
        self.server = self.stack.enter_context(Cached(self.binary, ("name: main",), grpc="127.0.0.1:0"))
        self.central = self.server.process.stdout.readline().decode().split()[1]
        for folder in ("uber", "manifests"):
            shutil.copytree(ROOT / folder, self.home / folder)
        self.build("here.kiln")
        return self

    def __exit__(self, *failure):
        return self.stack.__exit__(*failure)

    def node(self, name):
        return self.stack.enter_context(Node(self.central, self.home, name))

    def build(self, table, *words, cache="none", worker=None, after=None):
        """The build's report and what it said beside it. `after`: called while it runs."""
        environment = {"PATH": os.environ["PATH"], "HOME": str(self.home), **({"KILN_WORKER": str(worker)} if worker else {})}
        command = [KILN, "build", "manifests/sky_light.yaml", "-o", table, "--cache", str(cache), "--json", *words]
        process = subprocess.Popen(command, cwd=self.home, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        if after:
            after()
        out, err = process.communicate(timeout=120)
        equal(process.returncode, 0, "kiln's exit code, with " + err.decode())
        return json.loads(out), err.decode()

    def same(self, table):
        for end in ("", ".proof"):
            equal((self.home / (table + end)).read_bytes() == (self.home / ("here.kiln" + end)).read_bytes(), True, f"{table}{end} is as built here")

    def slow_worker(self, seconds):
        worker = self.home / f"slow-{seconds}"
        worker.write_text(f"#!/bin/sh\n: > {self.home}/started\nsleep {seconds}\nexec {REAL_WORKER} \"$@\"\n")
        worker.chmod(0o755)
        return worker

    def wait_started(self):
        for _ in range(200):
            if (self.home / "started").exists():
                return
            time.sleep(0.05)
        check(False, "no worker was started")


def execution(report):
    e = report["execution"]
    equal(e["answered"] + 0, e["questions"] if e["failed_batches"] == 0 else e["answered"], "questions answered")
    return e


def fleet(binary):
    """Built by nodes; then from the action cache, by another client, on a node that has nothing; then without the outputs' blobs."""
    with Fleet(binary) as f:
        one, two = f.node("one"), f.node("two")
        report, said = f.build("one.kiln", "--execute", f"{one.url},{two.url}")
        f.same("one.kiln")
        first = execution(report)
        equal((report["work"]["compiled"], report["work"]["translated"]), (0, 0), "compiled and translated here")
        check(first["questions"] > 10 and first["batches"] >= 2 and first["failed_batches"] == first["cached_batches"] == 0, f"{first} {said}")

        report, _ = f.build("two.kiln", "--execute", f"{two.url},{one.url}")
        f.same("two.kiln")
        equal(execution(report)["cached_batches"], first["batches"], "batches from the action cache")
        three = f.node("three")
        report, _ = f.build("three.kiln", "--execute", three.url)
        f.same("three.kiln")
        equal(execution(report)["cached_batches"], first["batches"], "batches from the action cache on a new node")

        # The server loses all blobs: no action is a hit any more, and the worker travels again.
        shutil.rmtree(f.server.folder / "blob")
        (f.server.folder / "blob").mkdir()
        four = f.node("four")
        report, said = f.build("four.kiln", "--execute", four.url)
        f.same("four.kiln")
        e = execution(report)
        equal((e["cached_batches"], e["failed_batches"]), (0, 0), "cached and failed batches after the loss: " + said)


def hurt_cache(binary):
    """With a local store that loses, fails and flips."""
    with Fleet(binary) as f:
        one = f.node("one")
        for seed in (1, 2):
            _, said = f.build("hurt.kiln", "--execute", one.url, "--chaos", f"seed={seed},loss=0.2,error=0.2,flip=0.3", cache=f.home / "c")
            check("chaos: lost" in said, "nothing was hurt: " + said)
            f.same("hurt.kiln")


def killed(binary):
    """A node that dies while it works: its work goes to the other. Without another it is done here, with one warning."""
    with Fleet(binary) as f:
        worker = f.slow_worker(2)
        one, two = f.node("one"), f.node("two")

        def kill_one():
            f.wait_started()
            one.end(signal.SIGKILL)

        report, said = f.build("a.kiln", "--execute", f"{one.url},{two.url}", worker=worker, after=kill_one)
        f.same("a.kiln")
        e = execution(report)
        equal((e["failed_batches"], report["work"]["compiled"]), (0, 0), "failed batches and classes compiled here: " + said)

        (f.home / "started").unlink()
        three = f.node("three")

        def kill_three():
            f.wait_started()
            three.end(signal.SIGKILL)

        report, said = f.build("b.kiln", "--execute", three.url, worker=f.slow_worker(3), after=kill_three)
        f.same("b.kiln")
        check(execution(report)["failed_batches"] > 0 and report["work"]["compiled"] > 0, f"nothing was done here: {report['execution']}")
        equal(said.count("warning: "), 1, "warnings: " + said)


def troubles(binary):
    """Nobody there, a server that does not execute, workers that fail, hang and lie: the table is the same, and one warning says why."""
    with Fleet(binary) as f:
        one = f.node("one")

        def hurt(what, url, *words, worker=None, says=""):
            report, said = f.build("x.kiln", "--execute", url, *words, worker=worker)
            f.same("x.kiln")
            check(execution(report)["failed_batches"] > 0, f"{what}: no batch failed")
            equal(said.count("warning: "), 1, f"{what}: warnings: {said}")
            check(says in said, f"{what}: {said}")

        def worker(text):
            path = f.home / f"worker-{abs(hash(text))}"
            path.write_text("#!/bin/sh\n" + text + "\n")
            path.chmod(0o755)
            return path

        report, _ = f.build("x.kiln", "--execute", one.url)  # the control
        equal(execution(report)["failed_batches"], 0, "failed batches of a good node")
        hurt("nobody there", f"grpc://127.0.0.1:{free_port()}", says="cannot be reached")
        hurt("kiln-cached itself", f"grpc://{f.central}/main", says="does not execute")
        hurt("fails", one.url, worker=worker("echo no such thing >&2; exit 3"), says="no such thing")
        hurt("hangs", one.url, "--execute-timeout", "1", worker=worker("exec sleep 6"), says="in time")
        hurt("no answers", one.url, worker=worker("exit 0"), says="answers")
        hurt("lies", one.url, worker=worker("head -c 10000 /dev/zero > answers"))


if __name__ == "__main__":
    peers = Peers()
    main([fleet, hurt_cache, killed, troubles])
