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
from tls_test import Certificates

KILN = os.path.abspath(os.environ["KILN"])
REAL_WORKER = pathlib.Path(KILN).parent / "kiln-worker"
peers = None


class Node(Daemon):
    """A casd that runs one action at a time. `more`: further settings of its two connections to the server."""

    def __init__(self, central, home, name, more=()):
        port = free_port()
        self.url = f"grpc://127.0.0.1:{port}"
        shared = [f"--{which}-{what}" for which in ("cas", "ac") for what in (f"remote={central}", "instance=main", "retry-limit=1", *more)]
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
        return self.stack.enter_context(Node("http://" + self.central, self.home, name))

    def start(self, table, *words, cache="none", worker=None, manifest="sky_light", **more):
        environment = {"PATH": os.environ["PATH"], "HOME": str(self.home), **({"KILN_WORKER": str(worker)} if worker else {}), **more}
        command = [KILN, "build", f"manifests/{manifest}.yaml", "-o", table, "--cache", str(cache), "--json", *words]
        return subprocess.Popen(command, cwd=self.home, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE)

    def build(self, table, *words, after=None, **more):
        """The build's report and what it said beside it. `after`: called while it runs."""
        process = self.start(table, *words, **more)
        if after:
            after()
        out, err = process.communicate(timeout=120)
        equal(process.returncode, 0, "kiln's exit code, with " + err.decode())
        return json.loads(out), err.decode()

    def same(self, table, other="here.kiln"):
        for end in ("", ".proof"):
            equal((self.home / (table + end)).read_bytes() == (self.home / (other + end)).read_bytes(), True, f"{table}{end} is as built here")

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

        # Several shaders, a scene, and another build's batches in the same store.
        scene = ("--scene", "manifests/scenes/renderer_valley.yaml")
        f.build("valley.kiln", *scene, manifest="renderer")
        for _ in range(2):
            report, said = f.build("valley_away.kiln", *scene, "--execute", f"{one.url},{two.url}", manifest="renderer")
            f.same("valley_away.kiln", "valley.kiln")
            equal((report["work"]["compiled"], report["work"]["translated"]), (0, 0), "compiled and translated here: " + said)
        equal(execution(report)["cached_batches"], execution(report)["batches"], "batches of the second build from the action cache")

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


def running(word):
    """The processes, of the whole machine, one of whose arguments is `word`."""
    found = []
    for line in pathlib.Path("/proc").glob("[0-9]*/cmdline"):
        try:
            if word.encode() in line.read_bytes().split(b"\0"):
                found.append(line.parent.name)
        except OSError:
            pass
    return found


def interrupted(binary):
    """Ctrl-C while a worker works, on a node and as a process here: kiln ends by the signal, the worker is ended, nothing is left."""
    with Fleet(binary) as f:
        one = f.node("one")
        for engine, nap in ((one.url, "98.7654301"), ("local:2", "98.7654302")):
            (f.home / "started").unlink(missing_ok=True)
            process = f.start("c.kiln", "--execute", engine, worker=f.slow_worker(nap), TMPDIR=str(f.home), cache=f.home / "cache")
            f.wait_started()
            time.sleep(0.2)
            check(running(nap), "the control: no worker is seen at work")
            process.send_signal(signal.SIGINT)
            err = process.communicate(timeout=20)[1].decode()
            equal((process.returncode, err), (-signal.SIGINT, "kiln: error: interrupted\n"), engine + ": how kiln ended")
            for _ in range(100):
                if not running(nap):
                    break
                time.sleep(0.1)
            equal(running(nap), [], engine + ": workers that go on")
            left = [path.name for path in f.home.iterdir() if path.name.startswith(("c.kiln", "kiln-job-"))]
            equal(left, [], engine + ": files left")


def central(binary):
    """The server behind the nodes is killed while one of them works, and started again: the build goes on, and so does the next."""
    with Fleet(binary) as f:
        one, two = f.node("one"), f.node("two")
        url = f"{one.url},{two.url}"
        again = []

        def kill_central():
            f.wait_started()
            f.server.process.kill()
            f.server.process.wait()
            time.sleep(0.2)
            again.append(f.stack.enter_context(Cached(binary, ("name: main",), folder=f.server.folder, listen=f"127.0.0.1:{f.server.port}", grpc=f.central)))
            f.server.process = again[0].process  # its end is looked at by both

        _, said = f.build("a.kiln", "--execute", url, worker=f.slow_worker(1), after=kill_central)
        f.same("a.kiln")
        check(said.count("warning: ") <= 1, "warnings: " + said)
        report, said = f.build("b.kiln", "--execute", url)
        f.same("b.kiln")
        equal((execution(report)["failed_batches"], said), (0, ""), "failed batches after the server was there again")


PROXY = """daemon off; pid {home}/nginx.pid; error_log {home}/nginx.log; worker_processes 1; {user}
events {{ worker_connections 256; }}
http {{
  access_log off; client_body_temp_path {home}/nginx-body; proxy_temp_path {home}/nginx-proxy; fastcgi_temp_path {home}/nginx-f; uwsgi_temp_path {home}/nginx-u;
  scgi_temp_path {home}/nginx-s;
  server {{
    listen 127.0.0.1:{port} ssl http2; ssl_certificate {pair[0]}; ssl_certificate_key {pair[1]}; client_max_body_size 0; grpc_read_timeout 600s;
    location / {{ if ($http_authorization != "Bearer {token}") {{ return 401; }} grpc_pass {to}; }}
  }}
}}
"""


def secure(binary):
    """TLS and tokens all the way: kiln to a proxy before a node (nginx), the node to kiln-cached."""
    check(shutil.which("nginx"), "no nginx (Debian's nginx-extras)")
    with Fleet(binary) as f, Certificates() as made:
        pair, wrong, port = made.make("a"), made.make("b"), free_port()
        token = f.home / "node.token"
        token.write_text("a-token-of-the-nodes")
        kiln_token = f.home / "kiln.token"
        kiln_token.write_text("a-token-of-kilns\n")
        kiln_token.chmod(0o600)
        server = f.stack.enter_context(Cached(binary, ("name: main",), tokens=["nodes a-token-of-the-nodes main:read,cas-write,ac-write"], tls_certificate=pair[0], tls_key=pair[1], grpc="127.0.0.1:0"))
        address = server.process.stdout.readline().decode().split()[1]
        node = f.stack.enter_context(Node("https://" + address, f.home, "one", (f"server-cert={pair[0]}", f"access-token={token}")))
        (f.home / "nginx.conf").write_text(PROXY.format(home=f.home, port=port, pair=pair, token="a-token-of-kilns", to=node.url, user="user root;" * (os.geteuid() == 0)))
        f.stack.enter_context(Daemon(["nginx", "-p", f.home, "-c", f.home / "nginx.conf", "-e", f.home / "nginx.log"], f.home, port))
        url = f"grpcs://127.0.0.1:{port}"
        good = {"KILN_EXECUTE_CA": str(pair[0]), "KILN_EXECUTE_TOKEN_FILE": str(kiln_token)}
        report, said = f.build("a.kiln", "--execute", url, **good)
        f.same("a.kiln")
        e = execution(report)
        equal((e["failed_batches"], report["work"]["compiled"], said), (0, 0, ""), "failed batches and classes compiled here")
        report, _ = f.build("a.kiln", "--execute", url, **good)
        equal(execution(report)["cached_batches"], e["batches"], "batches from the action cache")
        check(any((server.folder / "action").rglob("?" * 64)), "the server behind holds no action")
        for what, says in (({"KILN_EXECUTE_CA": str(wrong[0])}, "cannot be reached"), ({"KILN_EXECUTE_TOKEN_FILE": ""}, "token may not")):
            report, said = f.build("b.kiln", "--execute", url, **{**good, **what})
            f.same("b.kiln")
            equal(execution(report)["answered"], 0, f"questions answered with {what}")
            check(said.count("warning: ") == 1 and says in said, f"with {what}: {said}")
        for secret in ("a-token-of-kilns", "a-token-of-the-nodes"):
            check(secret not in server.log() and secret not in (f.home / "nginx.log").read_text(), "a token is in a log")


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
    main([fleet, hurt_cache, killed, interrupted, central, secure, troubles])
