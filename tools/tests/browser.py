"""A headless Chromium, steered through its DevTools protocol."""

from __future__ import annotations

import asyncio
import base64
import json
import re
import shutil
import subprocess
import time
import urllib.request
from pathlib import Path
from typing import Any

import pytest
from tornado.websocket import websocket_connect

PROGRAMS = ("chromium", "chromium-browser", "google-chrome")
FLAGS = [
    "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-sync",
    "--disable-background-networking", "--disable-component-update", "--hide-scrollbars", "--remote-debugging-port=0",
]  # fmt: skip


class Browser:
    """One page. Use it in a `with`."""

    def __init__(self, folder: Path, width: int = 1440, height: int = 900) -> None:
        program = next((found for name in PROGRAMS if (found := shutil.which(name))), None)
        if program is None:
            pytest.skip("no Chromium here")
        self.folder, self.loop, self.sent = folder, asyncio.new_event_loop(), 0
        call = [
            program,
            *FLAGS,
            f"--user-data-dir={folder / 'profile'}",
            f"--window-size={width},{height}",
            "about:blank",
        ]
        self.process = subprocess.Popen(call, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        assert self.process.stderr is not None
        port = None
        for line in self.process.stderr:
            if found := re.search(r"DevTools listening on ws://[^:]+:(\d+)/", line):
                port = found[1]
                break
        assert port, "Chromium does not listen"
        with urllib.request.urlopen(f"http://127.0.0.1:{port}/json") as answer:
            page = next(one for one in json.load(answer) if one["type"] == "page")
        self.loop.run_until_complete(self.connect(page["webSocketDebuggerUrl"]))
        self.errors: list[str] = []
        self.do("Runtime.enable")

    def __enter__(self) -> Browser:
        return self

    def __exit__(self, *_: Any) -> None:
        self.socket.close()
        self.process.terminate()
        self.process.wait(10)
        self.loop.close()

    async def connect(self, url: str) -> None:
        self.socket = await websocket_connect(url, max_message_size=1 << 28)

    def do(self, method: str, **parameters: Any) -> Any:
        return self.loop.run_until_complete(asyncio.wait_for(self._do(method, parameters), 30))

    async def _do(self, method: str, parameters: dict[str, Any]) -> Any:
        self.sent += 1
        await self.socket.write_message(json.dumps({"id": self.sent, "method": method, "params": parameters}))
        while True:
            text = await self.socket.read_message()
            assert text is not None, "Chromium has gone"
            answer = json.loads(text)
            if answer.get("method") == "Runtime.exceptionThrown":
                self.errors.append(answer["params"]["exceptionDetails"].get("exception", {}).get("description", "?"))
            if answer.get("id") == self.sent:
                assert "error" not in answer, answer
                return answer["result"]

    def evaluate(self, expression: str) -> Any:
        answer = self.do("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        return answer["result"].get("value")

    def until(self, expression: str, seconds: float = 30.0, define: str = "") -> Any:
        """The expression's value as soon as it is true; `define` runs before it."""
        begin = time.monotonic()
        while True:
            self.evaluate(define)
            value = self.evaluate(expression)
            if value:
                return value
            assert time.monotonic() - begin < seconds, f"never true: {expression}; page errors: {self.errors}"
            time.sleep(0.1)

    def open(self, url: str) -> None:
        self.do("Page.navigate", url=url)

    def screenshot(self, name: str) -> Path:
        path = self.folder / name
        path.write_bytes(base64.b64decode(self.do("Page.captureScreenshot", format="png")["data"]))
        return path
