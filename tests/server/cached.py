"""Starts kiln-cached on a port of the kernel's choice and speaks to it, politely (call) or byte by byte (raw)."""
import base64
import hashlib
import http.client
import json
import os
import pathlib
import select
import shutil
import signal
import socket
import ssl
import subprocess
import sys
import tempfile
import time

EMPTY = hashlib.sha256(b"").hexdigest()
SKIP = 77  # ctest's code of a test that could not run


def key(data):
    return hashlib.sha256(data).hexdigest()


def skip(reason):
    print("SKIP: " + reason)
    sys.exit(SKIP)


class Failed(AssertionError):
    pass


def check(condition, what):
    if not condition:
        raise Failed(what)


def equal(got, want, what):
    check(got == want, f"{what}: {got!r}, not {want!r}")


class Reply:
    def __init__(self, status, headers, body):
        self.status, self.headers, self.body = status, headers, body


class Cached:
    """A server with a folder of its own. `instances`, `tokens`: lines of its files. Further arguments: its flags, '_' for '.'."""

    def __init__(self, binary, instances=(), tokens=None, folder=None, before=None, **flags):
        self.home = pathlib.Path(tempfile.mkdtemp(prefix="kiln-cached-"))
        self.folder = pathlib.Path(folder) if folder else self.home / "store"
        settings = {"folder": str(self.folder), "listen": "127.0.0.1:0", "sync": "none"}
        if tokens is not None:
            path = self.home / "tokens"
            path.touch(mode=0o600)
            path.write_text("".join(line + "\n" for line in tokens))
            settings["tokens"] = str(path)
        settings.update({name.replace("_", ".", 1) if name.split("_")[0] in ("limits", "timeouts", "threads", "tls") else name: str(value)
                         for name, value in flags.items()})
        words = [binary]
        if instances:
            config = self.home / "config.yaml"
            config.write_text("instances:\n" + "".join(f"  - {{{line}}}\n" for line in instances))
            words.append("--config=" + str(config))
        words += [f"--{name}={value}" for name, value in settings.items()]
        self.secure, self.certificate = "tls.certificate" in settings, settings.get("tls.certificate")
        self.log_path = self.home / "log"
        with open(self.log_path, "wb") as log:
            self.process = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=log, preexec_fn=before)
        line = self.process.stdout.readline().decode().split()
        if len(line) != 2 or line[0] != "http":
            self.process.kill()
            self.process.wait()
            raise Failed("kiln-cached did not start: " + self.log())
        self.port = int(line[1].rsplit(":", 1)[1])
        self.url = f"http{'s' if self.secure else ''}://127.0.0.1:{self.port}"

    def __enter__(self):
        return self

    def __exit__(self, failure, *_):
        if failure:
            print(self.log()[-2000:], file=sys.stderr)
        code = self.stop()
        shutil.rmtree(self.home, ignore_errors=True)
        if failure is None:
            equal(code, 0, "kiln-cached's exit code")

    def stop(self):
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGTERM)
            try:
                self.process.wait(30)
            except subprocess.TimeoutExpired:
                self.process.kill()
                self.process.wait()
                return -9
        return self.process.returncode

    def log(self):
        return self.log_path.read_text(errors="replace")

    def log_lines(self):
        return [json.loads(line) for line in self.log().splitlines()]

    def blob_path(self, name):
        return self.folder / "blob" / name[:2] / name

    def memory(self):
        """Bytes resident."""
        for line in pathlib.Path(f"/proc/{self.process.pid}/status").read_text().splitlines():
            if line.startswith("VmRSS"):
                return int(line.split()[1]) * 1024
        return 0

    def connect(self, timeout=20):
        s = socket.create_connection(("127.0.0.1", self.port), timeout)
        s.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        return s

    def call(self, method, path, body=None, token=None, **headers):
        headers = {name.replace("_", "-"): value for name, value in headers.items()}
        if token is not None:
            headers["Authorization"] = "Bearer " + token
        if self.secure:
            context = ssl.create_default_context(cafile=self.certificate)
            c = http.client.HTTPSConnection("127.0.0.1", self.port, timeout=20, context=context)
        else:
            c = http.client.HTTPConnection("127.0.0.1", self.port, timeout=20)
        try:
            c.request(method, path, body, headers)
            r = c.getresponse()
            return Reply(r.status, r.headers, r.read())
        finally:
            c.close()

    def put(self, data, instance="", **more):
        return self.call("PUT", f"{instance}/cas/{key(data)}", data, **more).status

    def get(self, data, instance="", **more):
        return self.call("GET", f"{instance}/cas/{key(data)}", **more)

    def raw(self, data, timeout=20, shut=False):
        """Everything that comes back until the server closes; b'' when it closes without a word."""
        with self.connect(timeout) as s:
            try:
                s.sendall(data)
                if shut:
                    s.shutdown(socket.SHUT_WR)
            except OSError:
                pass
            return read_all(s)


def read_all(s):
    got = b""
    while True:
        try:
            part = s.recv(65536)
        except ConnectionResetError:
            return got
        if not part:
            return got
        got += part


def statuses(answer):
    """The status codes of all responses in a byte string, by their lengths; None where it is not HTTP."""
    out = []
    while answer:
        head, gap, rest = answer.partition(b"\r\n\r\n")
        words = head.split(b" ", 2)
        if not gap or words[0] != b"HTTP/1.1":
            return None
        length = 0
        for line in head.split(b"\r\n")[1:]:
            name, _, value = line.partition(b":")
            if name.lower() == b"content-length":
                length = int(value)
        out.append(int(words[1]))
        answer = rest[length:]
    return out


def basic(password, user="x"):
    return "Basic " + base64.b64encode(f"{user}:{password}".encode()).decode()


def main(tests, needs_more=()):
    """Runs each function with the binary that the command line names; prints one line a test."""
    binary = os.path.abspath(sys.argv[1])
    chosen = sys.argv[2:]
    failed = 0
    for test in tests:
        if chosen and test.__name__ not in chosen:
            continue
        start = time.monotonic()
        try:
            test(binary)
            print(f"ok      {test.__name__} ({time.monotonic() - start:.1f} s)", flush=True)
        except Failed as failure:
            failed += 1
            print(f"FAILED  {test.__name__}: {failure}", flush=True)
    sys.exit(1 if failed else 0)


def readable(s, seconds):
    return bool(select.select([s], [], [], seconds)[0])
