"""PNG files as rows of RGB bytes, without further packages: shared by the scripts that put pictures together."""
import struct
import zlib


def read_png(file):
    """Rows of RGB bytes of a picture of ours: 8 bits a channel, not interlaced; alpha is laid on white."""
    data, at, packed, channels = file.read_bytes(), 8, b"", 3
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + size]
        if kind == b"IHDR":
            width, height, depth, color = struct.unpack(">IIBB", body[:10])
            channels = {2: 3, 6: 4}[color]
            if depth != 8 or body[12]:
                raise ValueError(f"{file}: not 8 bits a channel")
        if kind == b"IDAT":
            packed += body
        at += 12 + size
    raw, stride, rows = zlib.decompress(packed), width * channels, []
    before = bytearray(stride)
    for y in range(height):
        kind, row = raw[y * (stride + 1)], bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for i in range(stride if kind else 0):
            left = row[i - channels] if i >= channels else 0
            up, corner = before[i], before[i - channels] if i >= channels else 0
            guess = left + up - corner
            row[i] = (row[i] + (left, up, (left + up) // 2, min((left, up, corner), key=lambda v: abs(guess - v)))
                      [kind - 1]) & 255
        before = row
        rows.append(bytes(row) if channels == 3 else without_alpha(row))
    return rows


def without_alpha(row):
    if all(a == 255 for a in row[3::4]):
        return bytes(b for i, b in enumerate(row) if i % 4 != 3)
    out = bytearray()
    for i in range(0, len(row), 4):
        a = row[i + 3]
        out += bytes((c * a + 255 * (255 - a) + 127) // 255 for c in row[i:i + 3])
    return bytes(out)


def filtered(row, before):
    """The row in the form whose bytes are smallest: as it is, or as differences from the left or from above."""
    left = bytes(a - b & 255 for a, b in zip(row, b"\0\0\0" + row))
    up = bytes(a - b & 255 for a, b in zip(row, before))
    return min(((kind, form) for kind, form in enumerate((row, left, up))),
               key=lambda f: sum(v if v < 128 else 256 - v for v in f[1]))


def write_png(file, rows):
    """RGB, packed as tightly as filters of one row at a time allow."""
    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    packed, before = bytearray(), bytes(len(rows[0]))
    for row in rows:
        kind, form = filtered(row, before)
        packed += bytes((kind,)) + form
        before = row
    size = struct.pack(">IIBBBBB", len(rows[0]) // 3, len(rows), 8, 2, 0, 0, 0)
    file.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", size) + chunk(b"IDAT", zlib.compress(bytes(packed), 9)) +
                     chunk(b"IEND", b""))


def sheet(pictures, columns, blank=b"\xff\xff\xff"):
    """Pictures beside and below each other, each in a cell as large as the largest."""
    wide, high = max(len(p[0]) for p in pictures) // 3, max(len(p) for p in pictures)
    rows = []
    for first in range(0, len(pictures), columns):
        line = pictures[first:first + columns]
        for y in range(high):
            row = b"".join((p[y] if y < len(p) else b"") + blank * (wide - (len(p[0]) // 3 if y < len(p) else 0))
                           for p in line)
            rows.append(row + blank * (wide * (columns - len(line))))
    return rows
