#!/usr/bin/env python3
"""Extracts the uncompressed kernel from a bzImage: under emulation, unpacking takes seconds.

usage: extract_kernel.py BZIMAGE OUTPUT

Layout: Linux Documentation/arch/x86/boot.rst, "The Real-Mode Kernel Header".
"""

import lzma
import struct
import sys
from pathlib import Path

SETUP_SECTORS = 0x1F1  # offset of setup_sects; 0 means 4
PAYLOAD = 0x248        # offset of payload_offset and payload_length
SECTOR_BYTES = 512


def kernel_of(image):
    sectors = image[SETUP_SECTORS] or 4
    offset, length = struct.unpack_from("<II", image, PAYLOAD)
    start = (sectors + 1) * SECTOR_BYTES + offset
    # A decompressor stops where the stream ends: four bytes of length follow it.
    kernel = lzma.LZMADecompressor().decompress(image[start:start + length])
    if kernel[:4] != b"\x7fELF":
        raise ValueError("the payload is not an ELF file")
    return kernel


def main():
    source, target = map(Path, sys.argv[1:])
    try:
        target.write_bytes(kernel_of(source.read_bytes()))
    except (lzma.LZMAError, struct.error, ValueError) as error:
        print(f"extract_kernel: {source}: {error}; Debian compresses its kernels with xz",
              file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
