"""A headless Chromium, driven by the protocol of WebDriver (https://www.w3.org/TR/webdriver2/), for tests of pages."""

import base64
import contextlib
import json
import shutil
import socket
import subprocess
import time
import urllib.error
import urllib.request
from collections.abc import Iterator

TAB, ENTER, END, RIGHT = "\ue004", "\ue007", "\ue010", "\ue014"
DRIVER, BROWSER = "chromedriver", "chromium"
PATIENCE = 300  # s, for a script: a busy machine without a graphics card draws a spring in 3D slowly


class Browser:
    """A session of a driver that listens at an address."""

    def __init__(self, address: str) -> None:
        arguments = [
            "--headless=new",
            "--no-sandbox",
            "--disable-gpu",
            "--overwrite-device-scale-factor=1",
            "--enable-unsafe-swiftshader",
            "--disable-dev-shm-usage",
        ]
        wish = {
            "alwaysMatch": {
                "browserName": "chrome",
                "goog:chromeOptions": {"args": arguments},
                "timeouts": {"script": 1000 * PATIENCE},
            }
        }
        self.address = f"{address}/session"
        self.address += "/" + self._ask("POST", "", {"capabilities": wish})["sessionId"]

    def _ask(self, method, path, body=None):
        data = None if body is None else json.dumps(body).encode()
        asked = urllib.request.Request(self.address + path, data, {"Content-Type": "application/json"}, method=method)
        try:
            with urllib.request.urlopen(asked, timeout=PATIENCE) as answer:
                return json.load(answer)["value"]
        except urllib.error.HTTPError as error:
            raise RuntimeError(json.load(error)["value"]["message"]) from None

    def command(self, name, **parameters):
        """A command of Chromium's own (DevTools)."""
        return self._ask("POST", "/goog/cdp/execute", {"cmd": name, "params": parameters})

    def look(self, width, height=900, dark=False):
        """A window of a size, in a theme."""
        self.command(
            "Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=width < 600
        )
        theme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
        self.command("Emulation.setEmulatedMedia", features=[theme])

    def open(self, path):
        """Open a page and wait until it says that it is ready; seconds that this took."""
        began = time.monotonic()
        self._ask("POST", "/url", {"url": f"file://{path}"})
        while self.run("return document.documentElement.dataset.ready") != "yes":
            if time.monotonic() - began > 60.0:
                raise TimeoutError(self.run("return document.getElementById('trouble').textContent"))
            time.sleep(0.02)
        return time.monotonic() - began

    def run(self, script, *arguments):
        """What a script returns."""
        return self._ask("POST", "/execute/sync", {"script": script, "args": list(arguments)})

    def wait(self, script):
        """What a promise comes to."""
        body = {"script": f"const done = arguments[arguments.length - 1]; ({script}).then(done)", "args": []}
        return self._ask("POST", "/execute/async", body)

    def press(self, *keys):
        """Keys, one after the other."""
        actions = [{"type": kind, "value": key} for key in keys for kind in ("keyDown", "keyUp")]
        self._ask("POST", "/actions", {"actions": [{"type": "key", "id": "keyboard", "actions": actions}]})

    def picture(self, path, whole=True):
        """A PNG of the whole page, or of the window."""
        extra = {}
        if whole:
            size = self.command("Page.getLayoutMetrics")["cssContentSize"]
            extra = {"captureBeyondViewport": True, "clip": {**size, "scale": 1}}
        data = self.command("Page.captureScreenshot", format="png", **extra)["data"]
        path.write_bytes(base64.b64decode(data))

    def pdf(self, path):
        """The page as it is printed."""
        path.write_bytes(base64.b64decode(self.command("Page.printToPDF", printBackground=False)["data"]))

    def close(self):
        """End the session."""
        self._ask("DELETE", "")


def missing() -> str:
    """What a machine lacks for a browser; empty if nothing."""
    lacks = [name for name in (DRIVER, BROWSER) if shutil.which(name) is None]
    return f"there is no {' and no '.join(lacks)} (Debian: chromium, chromium-driver)" if lacks else ""


@contextlib.contextmanager
def chromium(address: str = "") -> Iterator[Browser]:
    """A browser of the driver at an address, or of one that is started and ended here."""
    with contextlib.ExitStack() as stack:
        if not address:
            with socket.socket() as free:
                free.bind(("127.0.0.1", 0))
                port = free.getsockname()[1]
            driver = subprocess.Popen([shutil.which(DRIVER), f"--port={port}"], stdout=subprocess.DEVNULL)
            stack.callback(driver.wait)
            stack.callback(driver.terminate)
            address = f"http://127.0.0.1:{port}"
            _until_it_listens(port)
        browser = Browser(address)
        stack.callback(browser.close)
        yield browser


def _until_it_listens(port):
    for _ in range(200):
        with socket.socket() as ask:
            if ask.connect_ex(("127.0.0.1", port)) == 0:
                return
        time.sleep(0.05)
    raise TimeoutError(f"{DRIVER} does not listen")
