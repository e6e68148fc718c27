"""Serves the page on this machine alone."""

from __future__ import annotations

import logging
import os
import signal
import socket

from bokeh.application import Application
from bokeh.application.handlers.function import FunctionHandler
from bokeh.document import Document
from bokeh.server.server import Server

from ..failure import Failure
from ..recording import Recording
from .page import Page

ADDRESS = "127.0.0.1"


def serve(recording: Recording, live: bool, port: int) -> None:
    """Until it is interrupted. Port 0: any that is free."""
    for noisy in ("bokeh", "tornado"):
        logging.getLogger(noisy).setLevel(logging.ERROR)

    def open_page(doc: Document) -> None:
        Page(doc, recording, live)

    try:
        with socket.create_server((ADDRESS, port)) as free:
            port = free.getsockname()[1]
        server = Server(
            {"/": Application(FunctionHandler(open_page))},
            address=ADDRESS,
            port=port,
            allow_websocket_origin=[f"{host}:{port}" for host in ("localhost", ADDRESS)],
        )
    except OSError as error:
        reason = os.strerror(error.errno) if error.errno else str(error)
        raise Failure(f"port {port}: cannot listen on it: {reason}; --port names another") from error
    print(f"http://localhost:{port}/", flush=True)
    server.start()
    signal.signal(signal.SIGTERM, lambda *_: server.io_loop.add_callback_from_signal(server.io_loop.stop))
    try:
        server.io_loop.start()
    except KeyboardInterrupt:
        pass
