#!/usr/bin/env python3
"""The status page in headless Chromium, wide and narrow, light and dark, with a hostile name in every place that shows one.

usage: status_page_test.py KILN_CACHED [SCREENSHOTS]
"""
import base64
import importlib.util
import os
import pathlib
import shutil
import sys
import tempfile

from cached import Cached, check, equal, key, skip

spec = importlib.util.spec_from_file_location("page", pathlib.Path(__file__).resolve().parent.parent / "report" / "page.py")
page = importlib.util.module_from_spec(spec)
spec.loader.exec_module(page)

CONTRAST = """
  function rgb(c) { return c.match(/[0-9.]+/g).map(Number); }
  function light(c) { return rgb(c).slice(0, 3).map(function (v) { v /= 255; return v <= 0.03928 ? v / 12.92 : Math.pow((v + 0.055) / 1.055, 2.4); })
    .reduce(function (s, v, i) { return s + v * [0.2126, 0.7152, 0.0722][i]; }, 0); }
  function ground(e) { for (; e; e = e.parentElement) { var c = getComputedStyle(e).backgroundColor; if (rgb(c).length < 4 || rgb(c)[3] > 0.99) return c; }
    return matchMedia('(prefers-color-scheme: dark)').matches ? 'rgb(0,0,0)' : 'rgb(255,255,255)'; }
  var worst = [99, ''];
  document.querySelectorAll('body *').forEach(function (e) {
    if (!Array.from(e.childNodes).some(function (n) { return n.nodeType === 3 && n.textContent.trim(); }) || !e.getClientRects().length) return;
    var a = light(getComputedStyle(e).color), b = light(ground(e)), r = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
    if (r < worst[0]) worst = [r, e.textContent.slice(0, 40)];
  });
  return worst;"""


def fill(server, secret):
    """Some traffic of every kind."""
    value = lambda text: b"\x2a" + bytes([len(text)]) + text
    action = key(b"a")
    for instance in ("/main", "/pr/7", "/pr/a-rather-long-name-of-a-branch-that-somebody-has-chosen-for-it"):
        server.call("GET", f"{instance}/ac/{action}", token=secret)
        server.call("PUT", f"{instance}/cas/{key(b'blob')}", b"blob", token=secret)
        server.call("PUT", f"{instance}/ac/{action}", value(b"one"), token=secret)
        server.call("PUT", f"{instance}/ac/{action}", value(b"two"), token=secret)
        server.call("GET", f"{instance}/ac/{action}", token=secret)
        server.call("GET", f"{instance}/cas/{key(b'blob')}", token=secret)
    server.call("PUT", f"/main/cas/{key(b'x')}", b"y", token=secret)
    server.call("GET", "/main/ac/" + action)
    server.call("GET", "/ac/" + action, token=secret)


def main():
    binary = os.path.abspath(sys.argv[1])
    shots = pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else None
    for program in ("chromedriver", "chromium"):
        if shutil.which(program) is None:
            skip(program + " is not installed")
    secret = "the-token-of-who-looks-at-it"
    hostile = "<script>document.title='owned'</script><img/src=x>&amp;\"'"
    with tempfile.TemporaryDirectory() as profile, Cached(
            binary, instances=["name: main", 'name: "pr/*", parent: main'],
            tokens=[f"{hostile[:64]} {secret} main:read,cas-write,ac-write pr/*:read,cas-write,ac-write"]) as server:
        browser = page.Browser(profile)
        try:
            url = f"http://x:{secret}@127.0.0.1:{server.port}/status"
            browser.do("/url", url=url)
            text = browser.js("return document.body.innerText")
            check("kiln-cached" in text and "of 0 action lookups" in text, "an empty server: " + text[:200])
            fill(server, secret)
            browser.do("/url", url=url)
            check(browser.js("return document.title") == "kiln-cached", "a caller's name ran as a script")
            equal(browser.js("return document.querySelectorAll('script, img, iframe').length"), 0, "foreign elements")
            text = browser.js("return document.body.innerText")
            for part in ("main", "(no name)", "pr/7", "a-rather-long-name", "conflict", hostile[:30]):
                check(part in text, f"the page lacks {part!r}: {text}")
            check("%" in text, "no hit rate")
            check(secret not in browser.js("return document.documentElement.outerHTML"), "the token is on the page")
            for width in (1200, 360):
                for scheme in ("light", "dark"):
                    browser.screen(width, 900, scheme)
                    wide = browser.js("return [document.documentElement.scrollWidth, innerWidth]")
                    check(wide[0] <= wide[1], f"the page is {wide[0]} wide on a screen of {wide[1]}, {scheme}")
                    ratio, where = browser.js(CONTRAST)
                    check(ratio >= 4.5, f"contrast {ratio:.2f} at {where!r}, {scheme}")
                    if shots:
                        shots.mkdir(parents=True, exist_ok=True)
                        (shots / f"status-{width}-{scheme}.png").write_bytes(base64.b64decode(browser.call("GET", browser.session + "/screenshot")))
            grounds = []
            for scheme in ("light", "dark"):
                browser.screen(1200, 900, scheme)
                grounds.append(browser.js("return getComputedStyle(document.body).backgroundColor + getComputedStyle(document.body).color"))
            check(grounds[0] != grounds[1], "light and dark look the same")
            log = browser.do("/se/log", type="browser")
            check(not [entry for entry in log if entry["level"] == "SEVERE" and "favicon" not in entry["message"]], f"console: {log}")
            browser.do("/url", url=f"http://127.0.0.1:{server.port}/healthz")
        finally:
            browser.close()
    print("ok      status page")


if __name__ == "__main__":
    main()
