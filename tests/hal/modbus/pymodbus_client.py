"""An independent client for our server: reads the registers given below and prints them as JSON.

usage: pymodbus_client.py tcp PORT | rtu PATH

Three clients at once over TCP; a rejected request is printed as its exception code.
"""

import json
import logging
import sys

from pymodbus.client import ModbusSerialClient, ModbusTcpClient

logging.disable()  # pymodbus 3.8 (Debian 13) reports each exception that a server answers with


def client():
    if sys.argv[1] == "tcp":
        made = ModbusTcpClient("127.0.0.1", port=int(sys.argv[2]), timeout=5)
    else:
        made = ModbusSerialClient(sys.argv[2], baudrate=115200, parity="N", timeout=5)
    if not made.connect():
        raise SystemExit("cannot connect")
    return made


def code(reply):
    return getattr(reply, "exception_code", None)


clients = [client() for _ in range(3 if sys.argv[1] == "tcp" else 1)]
first = clients[0]
found = {
    "strain": [c.read_input_registers(0, count=10, slave=1).registers for c in clients],
    "identification": first.read_holding_registers(100, count=2, slave=1).registers,
    "button": first.read_discrete_inputs(16, count=1, slave=1).bits[0],
    "beyond": code(first.read_input_registers(5, count=10, slave=1)),
    "write": code(first.write_register(100, 1, slave=1)),
    "after": first.read_holding_registers(100, count=2, slave=1).registers,
}
if sys.argv[1] == "tcp":
    found["unit"] = code(first.read_input_registers(0, count=1, slave=2))
for c in clients:
    c.close()
print(json.dumps(found))
