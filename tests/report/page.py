#!/usr/bin/env python3
"""Opens the page of kiln report in headless Chromium, on a wide and on a narrow screen, light and dark, and clicks it.

usage: page.py KILN [--all] [SCREENSHOTS]. Two families are measured, or with --all every one. Speaks to chromedriver by the WebDriver protocol, so Python's own library is enough.
"""
import base64
import json
import os
import pathlib
import socket
import subprocess
import sys
import tempfile
import time
import urllib.request

FLAGS = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
         "--disable-component-update", "--disable-sync"]


class Browser:
    def __init__(self, folder):
        with socket.socket() as s:
            s.bind(("127.0.0.1", 0))
            self.port = s.getsockname()[1]
        self.driver = subprocess.Popen(["chromedriver", f"--port={self.port}"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        for _ in range(100):
            try:
                self.call("GET", "/status")
                break
            except OSError:
                time.sleep(0.1)
        arguments = FLAGS + [f"--user-data-dir={folder}"]
        options = {"args": arguments, "binary": os.environ.get("CHROMIUM", "/usr/bin/chromium")}
        answer = self.call("POST", "/session", {"capabilities": {"alwaysMatch": {
            "browserName": "chrome", "goog:chromeOptions": options, "goog:loggingPrefs": {"browser": "ALL"}}}})
        self.session = "/session/" + answer["sessionId"]

    def call(self, method, path, body=None):
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(f"http://127.0.0.1:{self.port}{path}", data, {"Content-Type": "application/json"}, method=method)
        with urllib.request.urlopen(request, timeout=60) as answer:
            return json.load(answer)["value"]

    def do(self, command, **body):
        return self.call("POST", self.session + command, body)

    def js(self, script, *args):
        return self.do("/execute/sync", script=script, args=list(args))

    def devtools(self, command, **params):
        return self.do("/goog/cdp/execute", cmd=command, params=params)

    def screen(self, width, height, scheme):
        self.devtools("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=width < 600)
        self.devtools("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": scheme}])

    def click(self, selector):
        element = self.do("/element", using="css selector", value=selector)
        self.do("/element/" + next(iter(element.values())) + "/click")

    def close(self):
        try:
            self.call("DELETE", self.session)
        finally:
            self.driver.terminate()
            self.driver.wait()


def check(condition, what):
    if not condition:
        sys.exit("FAILED: " + what)


def overlaps(browser):
    """Pairs of labels of one visible plot whose boxes meet."""
    return browser.js("""
        var out = [];
        document.querySelectorAll('svg.plot').forEach(function (svg) {
          if (!svg.getClientRects().length) return;
          var boxes = Array.from(svg.querySelectorAll('.label')).map(function (l) { return [l.textContent, l.getBoundingClientRect()]; });
          boxes.forEach(function (a, i) { boxes.slice(0, i).forEach(function (b) {
            var r = a[1], s = b[1];
            if (r.left < s.right - 1 && s.left < r.right - 1 && r.top < s.bottom - 1 && s.top < r.bottom - 1) out.push(a[0] + '/' + b[0]);
          }); });
        });
        return out;""")


def run(kiln, families, pictures):
    with tempfile.TemporaryDirectory() as folder:
        chosen = [word for family in families for word in ("--family", family)]
        subprocess.run([kiln, "report", "--quick", *chosen, "-o", folder], check=True, stdout=subprocess.DEVNULL)
        page = pathlib.Path(folder, "report.html")
        report = json.loads(pathlib.Path(folder, "report.json").read_text())
        fresnel = next(f for f in report["families"] if f["number"] == 4)
        if not families:
            check([f["number"] for f in report["families"]] == list(range(1, 14)), "thirteen families")
        browser = Browser(folder + "/profile")
        try:
            grounds = {}
            for name, width, height, scheme in (("desktop_light", 1280, 900, "light"), ("desktop_dark", 1280, 900, "dark"),
                                                ("phone_light", 390, 844, "light"), ("phone_dark", 390, 844, "dark")):
                browser.screen(width, height, scheme)
                browser.do("/url", url=page.as_uri())
                check(browser.js("return document.title") == "Error against run time", "title")
                wide = browser.js("return document.documentElement.scrollWidth")
                check(wide <= width, f"{name}: the page is {wide} wide and the screen {width}")
                met = overlaps(browser)
                check(not met, f"{name}: labels overlap: {met}")
                # Every part of every family is whole when its turn comes: as many points as it has measured, labels apart.
                for f in report["families"]:
                    for part in range(len(f["scenes"]) + 1):
                        here = f"f{f['number']}-{part}"
                        browser.js("document.querySelector(arguments[0]).click()", f"[data-part='{here}']")
                        check(browser.js("return !document.getElementById(arguments[0]).hidden", here), f"{name}: {here} is not shown")
                        rows = browser.js("return document.querySelectorAll('#' + arguments[0] + ' tbody tr').length", here)
                        check(rows == len(f["together"]["members"]), f"{name}: {here} has {rows} rows")
                        met = overlaps(browser)
                        check(not met, f"{name}: {here}: labels overlap: {met}")
                        wide = browser.js("return document.documentElement.scrollWidth")
                        check(wide <= width, f"{name}: {here}: the page is {wide} wide")
                    browser.js("document.querySelector(arguments[0]).click()", f"[data-part='f{f['number']}-0']")
                grounds[name] = browser.js("return getComputedStyle(document.body).backgroundColor")
                small = browser.js("return Array.from(document.querySelectorAll('svg.plot .label')).filter(e => e.getClientRects().length)"
                                   ".reduce((m, e) => Math.min(m, e.getBoundingClientRect().height), 99)")
                check(small >= 9, f"{name}: a label is {small} pixels high")

                # A point selects its row; what it says is what report.json says.
                browser.click("#f4-0 .point[data-row='f4-0-1'] .dot")
                chosen = browser.js("return Array.from(document.querySelectorAll('tr.selected')).map(r => r.cells[0].textContent)")
                check(chosen == [fresnel["together"]["members"][1]["member"]], f"{name}: selected {chosen}")
                check(browser.js("return document.querySelectorAll('#f4-0 .point.selected').length") == 2, f"{name}: the point of both plots")
                # A scene's part takes the place of the other, and a picture selects its point and row.
                browser.click("[data-part='f4-1']")
                check(browser.js("return document.getElementById('f4-0').hidden && !document.getElementById('f4-1').hidden"),
                      f"{name}: the scene's part is shown alone")
                browser.click("#f4-1 figure[data-row='f4-1-2'] img")
                kinds = browser.js("return Array.from(document.querySelectorAll('.selected')).map(e => e.tagName.toLowerCase()).sort()")
                check(kinds == ["figure", "g", "g", "tr"], f"{name}: a picture selected {kinds}")
                check(browser.js("return document.getElementById('f5-0').hidden") is False, f"{name}: the other family stays as it was")
                broken = browser.js("return Array.from(document.images).filter(i => !i.naturalWidth).length")
                check(broken == 0, f"{name}: {broken} pictures do not load")
                browser.js("document.querySelector('#f5-0 tr[data-row]').focus()")
                browser.do("/actions", actions=[{"type": "key", "id": "k", "actions": [{"type": "keyDown", "value": "\ue007"},
                                                                                      {"type": "keyUp", "value": "\ue007"}]}])
                check(browser.js("return document.querySelector('tr.selected').dataset.row") == "f5-0-0", f"{name}: Enter selects a row")
                if pictures:
                    pathlib.Path(pictures).mkdir(exist_ok=True)
                    browser.js("window.scrollTo(0, 0)")
                    shot = browser.devtools("Page.captureScreenshot", captureBeyondViewport=True)
                    pathlib.Path(pictures, name + ".png").write_bytes(base64.b64decode(shot["data"]))
            check(grounds["desktop_light"] != grounds["desktop_dark"], "light and dark look alike")
            errors = [e["message"] for e in browser.do("/se/log", type="browser") if e["level"] == "SEVERE"]
            check(not errors, f"the browser complains: {errors}")
        finally:
            browser.close()
    print("page: ok")


if __name__ == "__main__":
    words = [w for w in sys.argv[2:] if w != "--all"]
    run(sys.argv[1], [] if "--all" in sys.argv else ["4", "5"], words[0] if words else None)
