"""poison.py SERVER TOKEN_FILE LOG: what a bad pull request could try with its token. It knows every key that main's builds ask,
for it has computed the same (here they are read from the server's log). It gives each text's record to another key, whole in every
other way, and writes that into main, over what its own instance has, and into the instance of pull request 8."""
import http.client
import pathlib
import re
import sys
import urllib.parse

server, token_file, log = sys.argv[1:]
where = urllib.parse.urlsplit(server)
token = pathlib.Path(token_file).read_text().strip()
connection = http.client.HTTPConnection(where.hostname, where.port, timeout=20)


def call(method, path, body=None, token=token):
    connection.request(method, path, body, {"Authorization": "Bearer " + token} if token else {})
    reply = connection.getresponse()
    kept = reply.getheader("X-Kiln-Kept")  # what was there stays
    return 409 if kept else reply.status, reply.read()


def accepted(instance, values, token=token):
    return sum(call("PUT", f"/{instance}/ac/{key}", value, token)[0] in (200, 201, 204) for key, value in values.items())


keys = sorted(set(re.findall(r"/ac/([0-9a-f]{64})", pathlib.Path(log).read_text())))
values = {key: value for key in keys for status, value in [call("GET", f"/pr/7/ac/{key}")] if status == 200}
texts = [key for key, value in values.items() if value.count(bytes.fromhex(key)) == 2 and len(value) < 400]  # records of texts
wrong = {key: values[other].replace(bytes.fromhex(other), bytes.fromhex(key)) for key, other in zip(texts, texts[1:] + texts[:1])}
print(f"{len(keys)} keys, {len(wrong)} of them to be given another's text")
for instance in ("main", "pr/7", "pr/8"):
    print(f"{instance}: {accepted(instance, wrong)} of {len(wrong)} writes accepted")
    if accepted(instance, wrong, None):
        sys.exit(f"{instance}: written without a token")
blobs = set(re.findall(r"/cas/([0-9a-f]{64})", pathlib.Path(log).read_text()))
forged = sum(call("PUT", f"/pr/7/cas/{name}", b"other bytes")[0] in (200, 201, 204) for name in blobs)
print(f"blobs: {forged} of {len(blobs)} took other bytes")
