"""Read and write the codes of PNG, TGA, TIFF and EXR, sharing nothing with the
tools: the tests' own witness.

SPDX-License-Identifier: MIT

python3 codes.py print FILE [CHANNELS]    one texel a line, hexadecimal codes
python3 codes.py size FILE                width, height, channels, bits
python3 codes.py maps KIND BITS WxH FILE  make a test map: normal, ao, depth,
                                          plane or random; PNG
CHANNELS is a list of channel numbers such as 0,1. The sample codes of half and
float EXR files are their bits; its channels are put in the order R G B A.
"""

import math
import struct
import sys
import zlib


def unfilter(kind, row, above, bpp):
    for i in range(len(row)):
        a = row[i - bpp] if i >= bpp else 0
        b = above[i]
        c = above[i - bpp] if i >= bpp else 0
        if kind == 1:
            row[i] = (row[i] + a) & 255
        elif kind == 2:
            row[i] = (row[i] + b) & 255
        elif kind == 3:
            row[i] = (row[i] + (a + b) // 2) & 255
        elif kind == 4:
            p = a + b - c
            pa, pb, pc = abs(p - a), abs(p - b), abs(p - c)
            row[i] = (row[i] + (a if pa <= pb and pa <= pc
                                else b if pb <= pc else c)) & 255
    return row


def read_png(data):
    at, body, head = 8, b"", None
    while at < len(data):
        n, kind = struct.unpack(">I4s", data[at:at + 8])
        if kind == b"IHDR":
            head = struct.unpack(">IIBBBBB", data[at + 8:at + 8 + n])
        elif kind == b"IDAT":
            body += data[at + 8:at + 8 + n]
        at += 12 + n
    width, height, bits, colour, _, _, interlace = head
    nchans = {0: 1, 2: 3, 4: 2, 6: 4}[colour]
    if bits not in (8, 16) or interlace:
        raise ValueError("PNG: not 8 or 16 bits, or interlaced")
    bpp = nchans * bits // 8
    body = zlib.decompress(body)
    above = bytearray(width * bpp)
    fmt = ">%d%s" % (width * nchans, "H" if bits == 16 else "B")
    rows = []
    for y in range(height):
        start = y * (width * bpp + 1)
        row = bytearray(body[start + 1:start + 1 + width * bpp])
        above = unfilter(body[start], row, above, bpp)
        rows.append(list(struct.unpack(fmt, above)))
    return width, nchans, bits, rows


def read_tga(data):
    idlen, _, kind = data[0], data[1], data[2]
    width, height, bpp, flags = struct.unpack("<HHBB", data[12:18])
    nchans = bpp // 8
    at, texels = 18 + idlen, []
    while len(texels) < width * height:
        count, repeat = 1, 1
        if kind >= 8:
            count = (data[at] & 127) + 1
            if data[at] & 128:
                count, repeat = 1, count
            at += 1
        for _ in range(count):
            t = list(data[at:at + nchans])
            at += nchans
            if nchans >= 3:
                t[0], t[2] = t[2], t[0]
            texels += [t] * repeat
    rows = [sum(texels[y * width:(y + 1) * width], [])
            for y in range(height)]
    if not flags & 32:
        rows.reverse()
    return width, nchans, 8, rows


def read_tiff(data):
    e = "<" if data[:2] == b"II" else ">"
    at, = struct.unpack(e + "I", data[4:8])
    n, = struct.unpack(e + "H", data[at:at + 2])
    tags = {}
    for i in range(n):
        tag, kind, count = struct.unpack(
            e + "HHI", data[at + 2 + 12 * i:at + 10 + 12 * i])
        fmt = {1: "B", 2: "B", 3: "H", 4: "I"}.get(kind)
        if fmt is None:
            continue
        size = struct.calcsize(e + fmt) * count
        where = at + 10 + 12 * i
        if size > 4:
            where, = struct.unpack(e + "I", data[where:where + 4])
        tags[tag] = struct.unpack(e + "%d%s" % (count, fmt),
                                  data[where:where + size])
    width, height = tags[256][0], tags[257][0]
    bits, nchans = tags[258][0], tags.get(277, (1,))[0]
    compression, predictor = tags[259][0], tags.get(317, (1,))[0]
    if tags.get(284, (1,))[0] != 1 or compression not in (1, 8, 32946):
        raise ValueError("TIFF: planar, or compression %d" % compression)
    fmt = {8: "B", 16: "H", 32: "I"}[bits]
    flat, per_strip = [], tags.get(278, (height,))[0]
    for k, (start, size) in enumerate(zip(tags[273], tags[279])):
        strip = data[start:start + size]
        if compression != 1:
            strip = zlib.decompress(strip)
        nrows = min(per_strip, height - k * per_strip)
        for y in range(nrows):
            n = width * nchans
            row = strip[y * n * bits // 8:(y + 1) * n * bits // 8]
            if predictor == 3:
                b = bytearray(row)
                for i in range(nchans, len(b)):
                    b[i] = (b[i] + b[i - nchans]) & 255
                # byte planes, the most significant first
                row = bytes(b[p * n + i] for i in range(n)
                            for p in range(bits // 8))
                codes = list(struct.unpack(">%d%s" % (n, fmt), row))
            else:
                codes = list(struct.unpack(e + "%d%s" % (n, fmt), row))
            if predictor == 2:
                for i in range(nchans, n):
                    codes[i] = (codes[i] + codes[i - nchans]) & \
                        ((1 << bits) - 1)
            flat.append(codes)
    return width, nchans, bits, flat


def exr_header(data):
    at, attrs = 8, {}

    def text():
        nonlocal at
        end = data.index(b"\0", at)
        s, at = data[at:end].decode(), end + 1
        return s

    while data[at] != 0:
        name, kind = text(), text()
        size, = struct.unpack("<I", data[at:at + 4])
        attrs[name] = (kind, data[at + 4:at + 4 + size])
        at += 4 + size
    return attrs, at + 1


def read_exr(data):
    attrs, at = exr_header(data)
    x0, y0, x1, y1 = struct.unpack("<4i", attrs["dataWindow"][1])
    width, height = x1 - x0 + 1, y1 - y0 + 1
    channels, raw = [], attrs["channels"][1]
    i = 0
    while raw[i] != 0:
        end = raw.index(b"\0", i)
        kind, = struct.unpack("<I", raw[end + 1:end + 5])
        channels.append((raw[i:end].decode(), kind))
        i = end + 17
    compression = attrs["compression"][1][0]
    lines = {0: 1, 2: 1, 3: 16}.get(compression)
    if lines is None:
        raise ValueError("EXR: compression %d" % compression)
    nblocks = (height + lines - 1) // lines
    offsets = struct.unpack("<%dQ" % nblocks, data[at:at + 8 * nblocks])
    rows = [None] * height
    line_size = sum(width * (2 if k == 1 else 4) for _, k in channels)
    order = sorted(range(len(channels)), key=lambda c: (
        "RGBA".find(channels[c][0]) if channels[c][0] in "RGBA" else 9,
        channels[c][0]))
    for o in offsets:
        y, size = struct.unpack("<iI", data[o:o + 8])
        block = data[o + 8:o + 8 + size]
        nlines = min(lines, y1 - y + 1)
        if compression and size < nlines * line_size:
            b = bytearray(zlib.decompress(block))
            for i in range(1, len(b)):
                b[i] = (b[i - 1] + b[i] - 128) & 255
            half = (len(b) + 1) // 2
            out = bytearray(len(b))
            out[0::2], out[1::2] = b[:half], b[half:]
            block = bytes(out)
        p = 0
        for line in range(nlines):
            planes = []
            for _, kind in channels:
                n = width * (2 if kind == 1 else 4)
                planes.append(struct.unpack(
                    "<%d%s" % (width, "H" if kind == 1 else "I"),
                    block[p:p + n]))
                p += n
            rows[y - y0 + line] = [planes[c][x] for x in range(width)
                                   for c in order]
    return width, len(channels), 16 if channels[0][1] == 1 else 32, rows


def read(path):
    """(width, nchans, bits, rows of interleaved codes)"""
    with open(path, "rb") as f:
        data = f.read()
    if data[:4] == b"\x89PNG":
        return read_png(data)
    if data[:4] in (b"II*\0", b"MM\0*"):
        return read_tiff(data)
    if data[:4] == b"v/1\x01":
        return read_exr(data)
    return read_tga(data)


def write_png(path, rows, nchans, bits):
    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + \
            struct.pack(">I", zlib.crc32(kind + body))

    fmt = ">%d%s" % (len(rows[0]), "H" if bits == 16 else "B")
    body = b"".join(b"\0" + struct.pack(fmt, *r) for r in rows)
    head = struct.pack(">IIBBBBB", len(rows[0]) // nchans, len(rows), bits,
                       {1: 0, 2: 4, 3: 2, 4: 6}[nchans], 0, 0, 0)
    with open(path, "wb") as f:
        f.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) +
                chunk(b"IDAT", zlib.compress(body)) + chunk(b"IEND", b""))


def make_map(kind, bits, width, height):
    """Every code turns up; a third of the depths are 0."""
    state = 0x2545F491

    def number():
        nonlocal state
        state ^= state << 13 & 0xFFFFFFFF
        state ^= state >> 17
        state ^= state << 5 & 0xFFFFFFFF
        return state

    top, rows = (1 << bits) - 1, []
    for _ in range(height):
        row = []
        for _ in range(width):
            if kind == "normal":
                r = 0.98 * math.sqrt(number() / 4294967296.0)
                a = 2.0 * math.pi * number() / 4294967296.0
                n = (r * math.cos(a), r * math.sin(a),
                     math.sqrt(1.0 - r * r))
                row += [int(math.floor((c + 1.0) / 2.0 * top + 0.5))
                        for c in n]
            elif kind == "plane":
                row.append(top // 3)
            elif kind == "depth" and number() % 3 == 0:
                row.append(0)
            else:
                row.append((number() >> 8) & top)
        rows.append(row)
    return 3 if kind == "normal" else 1, rows


def main(argv):
    if argv[1] == "print":
        width, nchans, bits, rows = read(argv[2])
        chans = [int(c) for c in argv[3].split(",")] if len(argv) > 3 \
            else range(nchans)
        for row in rows:
            for x in range(width):
                print(" ".join("%0*x" % (bits // 4, row[x * nchans + c])
                               for c in chans))
    elif argv[1] == "size":
        width, nchans, bits, rows = read(argv[2])
        print(width, len(rows), nchans, bits)
    elif argv[1] == "maps":
        width, height = map(int, argv[4].split("x"))
        nchans, rows = make_map(argv[2], int(argv[3]), width, height)
        write_png(argv[5], rows, nchans, int(argv[3]))


if __name__ == "__main__":
    main(sys.argv)
