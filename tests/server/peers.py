"""Peers of a newer Debian suite (tools/peers.sh), run as processes of a test's own; without the suite the test is skipped."""
import os
import pathlib
import shutil
import signal
import socket
import subprocess
import tempfile
import time

from cached import check, skip

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent


class Peers:
    def __init__(self, bazel=False):
        words = [str(ROOT / "tools" / "peers.sh")] + (["--bazel"] if bazel else [])
        done = subprocess.run(words, capture_output=True, text=True)
        print(done.stdout, end="", flush=True)
        if done.returncode == 77:
            skip(done.stdout.strip().splitlines()[-1].removeprefix("SKIP: "))
        check(done.returncode == 0, "tools/peers.sh: " + done.stderr)
        self.folder = pathlib.Path(done.stdout.splitlines()[0].removeprefix("folder: "))

    def inside(self, *words):
        """The command line that runs a program inside the suite."""
        return [str(self.folder / "enter"), *map(str, words)]

    def tool(self, name, *words):
        """The command line of a buildbox program outside the suite."""
        return [str(self.folder / "bin" / name), *map(str, words)]


def has_bazel():
    folder = os.environ.get("KILN_PEERS") or os.path.join(os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache"), "kiln-peers")
    return os.path.exists(os.path.join(folder, os.environ.get("KILN_PEERS_SUITE", "forky"), "usr/bin/bazel"))


class Home:
    """An empty folder in /tmp, which the suite sees under the same name."""

    def __enter__(self):
        self.path = pathlib.Path(tempfile.mkdtemp(prefix="kiln-peer-", dir="/tmp"))
        return self.path

    def __exit__(self, *_):
        shutil.rmtree(self.path, ignore_errors=True)


def run(words, cwd, code=0, timeout=120, **environment):
    """Both output streams of a program that ends with `code`."""
    settings = {"PATH": os.environ["PATH"], "HOME": str(cwd), "LC_ALL": "C", **{k: str(v) for k, v in environment.items()}}
    process = subprocess.Popen(list(map(str, words)), cwd=cwd, env=settings, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, start_new_session=True)
    try:
        out = process.communicate(timeout=timeout)[0].decode(errors="replace")
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        out = process.communicate()[0].decode(errors="replace")
        check(False, f"{words} did not end: {out[-2000:]}")
    check(code is None or process.returncode == code, f"{words} ended with {process.returncode}: {out[-3000:]}")
    return out


class Daemon:
    """A peer that serves, with what it starts, until the block ends. `ready` is a port of loopback that answers."""

    def __init__(self, words, home, ready, **environment):
        self.log = pathlib.Path(home) / f"daemon-{ready}.log"
        settings = {"PATH": os.environ["PATH"], "HOME": str(home), "LC_ALL": "C", **environment}
        with open(self.log, "wb") as log:
            self.process = subprocess.Popen(list(map(str, words)), cwd=home, env=settings, stdout=log, stderr=log, start_new_session=True)
        for _ in range(300):
            check(self.process.poll() is None, f"{words[0]} ended: {self.text()}")
            try:
                socket.create_connection(("127.0.0.1", ready), 1).close()
                return
            except OSError:
                time.sleep(0.1)
        self.end()
        check(False, f"{words[0]} does not listen: {self.text()}")

    def text(self):
        return self.log.read_text(errors="replace")[-3000:]

    def end(self, how=signal.SIGTERM):
        """Ends it and, for those it leaves behind, its process group."""
        if self.process.poll() is None:
            self.process.send_signal(how)
            try:
                self.process.wait(10)
            except subprocess.TimeoutExpired:
                pass
        try:
            os.killpg(self.process.pid, signal.SIGKILL)
        except ProcessLookupError:
            pass
        self.process.wait()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.end()


def free_port():
    """A port that is free now. For peers that cannot say which one the kernel gave them."""
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]
