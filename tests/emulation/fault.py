"""fault.py IMAGE MESSAGES: the board IMAGE, which starts anew after so many messages."""
import os
import subprocess
import sys
from pathlib import Path

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).parent.parent / "board"))
import line

board = subprocess.Popen(sys.argv[1], stdin=sys.stdin, stdout=subprocess.PIPE)
left = 2 * int(sys.argv[2])
while left > 0:
    data = os.read(board.stdout.fileno(), 4096)
    os.write(sys.stdout.fileno(), data)
    left -= data.count(line.FLAG)
message = bytes([line.FAULT]) + line.fields(2, 0x1234)
os.write(sys.stdout.fileno(), bytes([line.FLAG]) + message + line.check_sequence(message) + bytes([line.FLAG]))
board.wait()
