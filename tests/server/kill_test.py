#!/usr/bin/env python3
"""kiln-cached killed by SIGKILL at random moments of mixed load, KILN_KILL_ROUNDS times (8; tools/test.sh --full asks for 200). After each
kill it starts again on the same folder and is audited: every entry that it acknowledged is there, or was evicted where the bound is
small, and no answer ever has wrong bytes. The seed is printed; KILN_KILL_SEED repeats it."""
import http.client
import json
import os
import pathlib
import random
import shutil
import subprocess
import tempfile
import threading
import time

from cached import Cached, Failed, check, equal, key, main
from protobuf_wire import field, varint

ROUNDS = int(os.environ.get("KILN_KILL_ROUNDS", "8"))
SEED = int(os.environ.get("KILN_KILL_SEED", "0")) or random.SystemRandom().randrange(1, 1 << 32)
WORKERS = 6
OK = (200, 201, 204)


def action_value(blobs, salt):
    """An ActionResult that names blobs."""
    files = b"".join(field(2, field(1, f"out/{n}".encode()) + field(2, field(1, key(b).encode()) + (b"\x10" + varint(len(b)) if b else b"")))
                     for n, b in enumerate(blobs))
    return files + field(5, salt)


class Load:
    """One client: writes blobs and actions that name them, asks for old ones, and notes what was acknowledged."""

    def __init__(self, port, seed, known):
        self.port, self.dice, self.known = port, random.Random(seed), known
        self.blobs, self.actions, self.wrong, self.answers = {}, {}, [], 0
        self.thread = threading.Thread(target=self.run, daemon=True)
        self.thread.start()

    def run(self):
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=20)
        try:
            while True:
                self.step(connection)
        except (OSError, http.client.HTTPException):
            pass  # the server is gone
        finally:
            connection.close()

    def call(self, connection, method, path, body=None):
        connection.request(method, path, body)
        reply = connection.getresponse()
        data = reply.read()
        self.answers += 1
        return reply.status, data

    def step(self, connection):
        what = self.dice.random()
        if what < 0.5:
            made = []
            for _ in range(self.dice.randrange(1, 4)):
                blob = self.dice.randbytes(int(self.dice.choice([0.01, 1, 20, 50, 200]) * 1024 * self.dice.random()))
                made.append(blob)
                if self.call(connection, "PUT", f"/cas/{key(blob)}", blob)[0] in OK:
                    self.blobs[key(blob)] = blob
            name, value = key(self.dice.randbytes(8)), action_value(made, self.dice.randbytes(40))
            if self.call(connection, "PUT", f"/ac/{name}", value)[0] in OK:
                self.actions[name] = value
        elif what < 0.6:
            # A blob cut off: announced longer than it is sent, on a connection of its own.
            blob = self.dice.randbytes(30000)
            other = http.client.HTTPConnection("127.0.0.1", self.port, timeout=20)
            try:
                other.putrequest("PUT", f"/cas/{key(blob)}")
                other.putheader("Content-Length", str(len(blob)))
                other.endheaders()
                other.send(blob[: self.dice.randrange(len(blob))])
            finally:
                other.close()
        else:
            for kind, mine, known in (("cas", self.blobs, self.known.blobs), ("ac", self.actions, self.known.actions)):
                table = mine if self.dice.random() < 0.5 or not known else known
                if not table:
                    continue
                name = self.dice.choice(list(table)[-500:])
                status, data = self.call(connection, "GET", f"/{kind}/{name}")
                if status == 200 and data != table[name]:
                    self.wrong.append((kind, name))


class Known:
    def __init__(self):
        self.blobs, self.actions = {}, {}


def audit(server, blobs, actions, may_be_gone):
    """(entries found, entries gone). Wrong bytes fail at once."""
    connection = http.client.HTTPConnection("127.0.0.1", server.port, timeout=60)
    found = gone = 0
    for kind, table in (("cas", blobs), ("ac", actions)):
        for name, want in table.items():
            connection.request("GET", f"/{kind}/{name}")
            reply = connection.getresponse()
            data = reply.read()
            if reply.status == 404 and may_be_gone:
                gone += 1
                continue
            equal(reply.status, 200, f"{kind}/{name}, which was acknowledged")
            check(data == want, f"{kind}/{name} has other bytes")
            found += 1
    connection.close()
    return found, gone


def rounds(binary, count, flags, may_be_gone, seed):
    dice = random.Random(seed)
    folder = pathlib.Path(tempfile.mkdtemp(prefix="kiln-kill-"))
    known, total, answers, evicted = Known(), 0, 0, 0
    kiln = pathlib.Path(binary).parent / "kiln"
    try:
        for n in range(count):
            server = Cached(binary, folder=folder / "store", log="off", **flags)
            try:
                loads = [Load(server.port, dice.randrange(1 << 30), known) for _ in range(WORKERS)]
                # Some rounds end with the first requests, most in the middle of load, whatever the speed of the machine.
                enough = int((dice.choice([0, 20, 100, 300]) if n else 300) * (1 + dice.random()))
                until = time.monotonic() + 30
                while sum(load.answers for load in loads) < enough and time.monotonic() < until:
                    time.sleep(0.005)
                time.sleep(0.05 * dice.random())
                server.process.kill()
                server.process.wait()
                for load in loads:
                    load.thread.join(60)
                    check(not load.thread.is_alive(), "a client hangs")
                    check(not load.wrong, f"wrong bytes under load: {load.wrong[:3]}")
                    answers += load.answers
            finally:
                server.process.kill()
                server.process.wait()
                shutil.rmtree(server.home, ignore_errors=True)
            fresh = Known()
            for load in loads:
                fresh.blobs.update(load.blobs)
                fresh.actions.update(load.actions)
            old = Known()
            old.blobs = dict(dice.sample(list(known.blobs.items()), min(200, len(known.blobs))))
            old.actions = dict(dice.sample(list(known.actions.items()), min(200, len(known.actions))))
            with Cached(binary, folder=folder / "store", log="off", **flags) as again:
                for part in (fresh, old):
                    found, gone = audit(again, part.blobs, part.actions, may_be_gone)
                    total, evicted = total + found, evicted + gone
            known.blobs.update(fresh.blobs)
            known.actions.update(fresh.actions)
        with Cached(binary, folder=folder / "store", log="off", **flags) as last:
            found, gone = audit(last, known.blobs, known.actions, may_be_gone)
        check(found > 0, "the last audit found nothing")
        # Every bit on the disk as well, by another program.
        if kiln.exists():
            done = subprocess.run([kiln, "cache", "verify", "--cache", folder / "store", "--json"], capture_output=True, text=True)
            did = json.loads(done.stdout)
            equal((done.returncode, did["damaged"], did["unreadable"]), (0, [], []), "kiln cache verify")
            check(did["checked"]["entries"] >= found, "verify saw fewer entries than the server has")
        print(f"  {count} kills, {answers} answers, {len(known.blobs) + len(known.actions)} entries acknowledged, {found} there at the end, "
              f"{gone} evicted, 0 wrong" + ("" if may_be_gone else ", 0 lost"), flush=True)
        return len(known.blobs) + len(known.actions), gone
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def nothing_acknowledged_is_lost(binary):
    made, _ = rounds(binary, max(1, ROUNDS * 3 // 4), {}, False, SEED)
    check(made > ROUNDS * 3, f"hardly any load: {made}")


def a_small_bound_evicts_and_never_lies(binary):
    _, gone = rounds(binary, max(1, ROUNDS // 4), {"limit": "2MiB"}, True, SEED + 1)
    check(gone > 0, "the bound was never reached")


def the_audit_finds_what_is_lost_or_wrong(binary):
    blob, other = b"a" * 5000, b"b" * 5000
    with Cached(binary, log="off", verify_again=0) as server:
        for b in (blob, other):
            check(server.put(b) in OK, "a put failed")
        equal(audit(server, {key(blob): blob, key(other): other}, {}, False), (2, 0), "the audit of a whole store")
        server.blob_path(key(blob)).unlink()
        for wanted in ({key(blob): blob}, {key(other): blob}):
            try:
                audit(server, wanted, {}, False)
            except Failed:
                continue
            raise Failed("the audit saw nothing")


print("seed", SEED, flush=True)
main([the_audit_finds_what_is_lost_or_wrong, nothing_acknowledged_is_lost, a_small_bound_evicts_and_never_lies])
