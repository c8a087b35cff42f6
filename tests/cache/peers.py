"""What the tests of the cache client start: nginx as a plain store of files, and servers that lie. Each listens on a port of
127.0.0.1 that the kernel chose, and is ended by its process id."""
import json
import os
import pathlib
import shutil
import socket
import subprocess
import sys
import tempfile
import time

KILN = os.environ["KILN"]


def fail(text):
    raise SystemExit("FAILED: " + text)


def check(condition, text):
    if not condition:
        fail(text)


def free_port():
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


def wait_for(port, process):
    for _ in range(400):
        if process.poll() is not None:
            return False
        with socket.socket() as s:
            if s.connect_ex(("127.0.0.1", port)) == 0:
                return True
        time.sleep(0.025)
    return False


class Nginx:
    """WebDAV over a folder. It checks no digest and knows no roles."""

    def __init__(self, folder, extra=""):
        nginx = shutil.which("nginx") or "/usr/sbin/nginx"
        if not os.path.exists(nginx):
            print("SKIP: no nginx here")
            sys.exit(77)
        self.folder = pathlib.Path(folder).absolute()
        (self.folder / "data").mkdir(parents=True, exist_ok=True)
        for _ in range(5):  # the port may be taken between its choice and its use
            self.port = free_port()
            (self.folder / "nginx.conf").write_text(f"""
daemon off; master_process off; pid {self.folder}/pid; error_log {self.folder}/error.log;
events {{ worker_connections 256; }}
http {{
  access_log {self.folder}/access.log combined;
  client_body_temp_path {self.folder}/body; proxy_temp_path {self.folder}/p; fastcgi_temp_path {self.folder}/f;
  uwsgi_temp_path {self.folder}/u; scgi_temp_path {self.folder}/s;
  keepalive_requests 100000;
  server {{
    listen 127.0.0.1:{self.port};
    location / {{ root {self.folder}/data; dav_methods PUT DELETE MKCOL; create_full_put_path on; client_max_body_size 256m; {extra} }}
  }}
}}
""")
            self.process = subprocess.Popen([nginx, "-c", f"{self.folder}/nginx.conf", "-p", str(self.folder)],
                                            stderr=subprocess.DEVNULL)
            if wait_for(self.port, self.process):
                break
            self.process.wait()
        else:
            fail("nginx does not start: " + (self.folder / "error.log").read_text())
        self.url = f"http://127.0.0.1:{self.port}"

    def requests(self):
        """(method, path, status) of everything asked so far."""
        rows = []
        for line in (self.folder / "access.log").read_text().splitlines():
            method, path, _ = line.split('"')[1].split(" ")
            rows.append((method, path, int(line.split('"')[2].split()[0])))
        return rows

    def stop(self):
        self.process.kill()
        self.process.wait()


def environment(**more):
    env = {k: v for k, v in os.environ.items() if not k.startswith("KILN_CACHE") and not k.lower().endswith("_proxy")}
    env.update(NO_COLOR="1", XDG_CACHE_HOME=os.getcwd() + "/no-home-cache")
    env.update({k: str(v) for k, v in more.items()})
    return env


class Run:
    def __init__(self, *words, code=0, **env):
        began = time.monotonic()
        done = subprocess.run([KILN, *map(str, words)], capture_output=True, text=True, env=environment(**env), timeout=280)
        self.seconds = time.monotonic() - began
        self.out, self.err = done.stdout, done.stderr
        if done.returncode != code:
            fail(f"exit code {done.returncode}, not {code}: {words}\n{self.out}\n{self.err}")
        self.json = json.loads(self.out) if "--json" in words else None
        self.remote = (self.json or {}).get("remote")


def build(manifest, table, *words, **env):
    return Run("build", manifest, "-o", table, "--json", *words, **env)


def same(a, b, what):
    for end in ("", ".proof"):
        if pathlib.Path(a + end).read_bytes() != pathlib.Path(b + end).read_bytes():
            fail(f"{what}: {a}{end} and {b}{end} differ")


SMALL = {
    "p/m.yaml": """kiln: 1
name: small
include: [lib]
targets: [spirv, glsl450]
axes:
  tint: {macro: TINT, values: [none, red, blue]}
  bright: {macro: BRIGHT, values: bool}
rules:
  - forbid: tint == none && bright
    because: nothing to brighten
shaders:
  - name: paint
    stages: {fragment: paint.frag}
""",
    "p/paint.frag": """#version 450
#include "tint.glsl"
layout(location = 0) out vec4 colour;
void main() {
    vec3 c = vec3(0.5);
#if TINT != 0
    c = tint(c);
#endif
#if BRIGHT
    c *= 2.0;
#endif
    colour = vec4(c, 1.0);
}
""",
    "p/lib/tint.glsl": """#if TINT == 1
vec3 tint(vec3 c) { return c * vec3(1.0, 0.2, 0.2); }
#elif TINT == 2
vec3 tint(vec3 c) { return c * vec3(0.2, 0.2, 1.0); }
#endif
""",
}


def in_folder(main):
    """Runs main in a folder of its own that holds the small project, and removes it."""
    root = tempfile.mkdtemp(prefix="kiln-peers-")
    os.chdir(root)
    try:
        for name, text in SMALL.items():
            pathlib.Path(name).parent.mkdir(parents=True, exist_ok=True)
            pathlib.Path(name).write_text(text)
        main()
    finally:
        os.chdir("/")
        shutil.rmtree(root, ignore_errors=True)
