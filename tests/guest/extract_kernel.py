#!/usr/bin/env python3
"""Extracts the uncompressed kernel from a bzImage: under emulation, unpacking takes seconds.

usage: extract_kernel.py BZIMAGE OUTPUT

Layout: Linux Documentation/arch/x86/boot.rst, "The Real-Mode Kernel Header".
"""

import lzma
import struct
import subprocess
import sys
from pathlib import Path

SETUP_SECTORS = 0x1F1  # offset of setup_sects; 0 means 4
PAYLOAD = 0x248        # offset of payload_offset and payload_length
SECTOR_BYTES = 512
ZSTD_MAGIC = b"\x28\xb5\x2f\xfd"  # Debian 13; Debian 12 compresses with xz
LENGTH_BYTES = 4  # the length of the kernel follows the stream


def kernel_of(image):
    sectors = image[SETUP_SECTORS] or 4
    offset, length = struct.unpack_from("<II", image, PAYLOAD)
    start = (sectors + 1) * SECTOR_BYTES + offset
    payload = image[start:start + length]
    if payload.startswith(ZSTD_MAGIC):
        kernel = subprocess.run(["zstd", "-dc"], input=payload[:-LENGTH_BYTES], check=True,
                                capture_output=True).stdout
    else:  # the decompressor stops where the stream ends
        kernel = lzma.LZMADecompressor().decompress(payload)
    if kernel[:4] != b"\x7fELF":
        raise ValueError("the payload is not an ELF file")
    return kernel


def main():
    source, target = map(Path, sys.argv[1:])
    try:
        target.write_bytes(kernel_of(source.read_bytes()))
    except (lzma.LZMAError, struct.error, subprocess.CalledProcessError, ValueError) as error:
        print(f"extract_kernel: {source}: {error}; expected a kernel compressed with xz or zstd",
              file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
