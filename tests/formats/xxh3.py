# SPDX-License-Identifier: MIT
"""XXH3-64 with seed 0 in plain Python, after xxHash's doc/xxhash_spec.md. Slow; independent of the C code."""

_MASK = 0xFFFFFFFFFFFFFFFF
_P32 = (0x9E3779B1, 0x85EBCA77, 0xC2B2AE3D)
_P64 = (0x9E3779B185EBCA87, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9, 0x85EBCA77C2B2AE63, 0x27D4EB2F165667C5)
_SECRET = bytes.fromhex(
    "b8fe6c3923a44bbe7c01812cf721ad1cded46de9839097db7240a4a4b7b3671f"
    "cb79e64eccc0e578825ad07dccff7221b8084674f743248ee03590e6813a264c"
    "3c2852bb91c300cb88d0658b1b532ea371644897a20df94e3819ef46a9deacd8"
    "a8fa763fe39c343ff9dcbbc7c70b4f1d8a51e04bcdb45931c89f7ec9d9787364"
    "eac5ac8334d3ebc3c581a0fffa1363eb170ddd51b7f0da49d316552629d4689e"
    "2b16be587d47a1fc8ff8b8d17ad031ce45cb3a8f95160428afd7fbcabb4b407e"
)


def _u32(data, at):
    return int.from_bytes(data[at : at + 4], "little")


def _u64(data, at):
    return int.from_bytes(data[at : at + 8], "little")


def _fold(a, b):
    product = a * b
    return (product & _MASK) ^ (product >> 64)


def _swap(value):
    return int.from_bytes(value.to_bytes(8, "little"), "big")


def _rotl(value, bits):
    return ((value << bits) | (value >> (64 - bits))) & _MASK


def _avalanche(h):
    h ^= h >> 37
    h = h * 0x165667919E3779F9 & _MASK
    return h ^ (h >> 32)


def _avalanche64(h):
    h ^= h >> 33
    h = h * _P64[1] & _MASK
    h ^= h >> 29
    h = h * _P64[2] & _MASK
    return h ^ (h >> 32)


def _short(data):
    size = len(data)
    if size == 0:
        return _avalanche64(_u64(_SECRET, 56) ^ _u64(_SECRET, 64))
    if size <= 3:
        combined = (data[0] << 16) | (data[size >> 1] << 24) | data[-1] | (size << 8)
        return _avalanche64(combined ^ _u32(_SECRET, 0) ^ _u32(_SECRET, 4))
    if size <= 8:
        h = _u32(data, size - 4) + (_u32(data, 0) << 32)
        h ^= _u64(_SECRET, 8) ^ _u64(_SECRET, 16)
        h ^= _rotl(h, 49) ^ _rotl(h, 24)
        h = h * 0x9FB21C651E98DF25 & _MASK
        h ^= (h >> 35) + size
        h = h * 0x9FB21C651E98DF25 & _MASK
        return h ^ (h >> 28)
    low = _u64(data, 0) ^ _u64(_SECRET, 24) ^ _u64(_SECRET, 32)
    high = _u64(data, size - 8) ^ _u64(_SECRET, 40) ^ _u64(_SECRET, 48)
    return _avalanche((size + _swap(low) + high + _fold(low, high)) & _MASK)


def _mix(data, at, key):
    return _fold(_u64(data, at) ^ _u64(_SECRET, key), _u64(data, at + 8) ^ _u64(_SECRET, key + 8))


def _medium(data):
    size = len(data)
    acc = size * _P64[0]
    if size <= 128:
        for i in reversed(range((size - 1) // 32 + 1)):
            acc += _mix(data, 16 * i, 32 * i) + _mix(data, size - 16 * (i + 1), 32 * i + 16)
        return _avalanche(acc & _MASK)
    for i in range(8):
        acc += _mix(data, 16 * i, 16 * i)
    acc = _avalanche(acc & _MASK)
    for i in range(8, size // 16):
        acc += _mix(data, 16 * i, 16 * (i - 8) + 3)
    acc += _mix(data, size - 16, 136 - 17)
    return _avalanche(acc & _MASK)


def _accumulate(acc, data, at, key):
    for i in range(8):
        value = _u64(data, at + 8 * i)
        keyed = value ^ _u64(_SECRET, key + 8 * i)
        acc[i ^ 1] = (acc[i ^ 1] + value) & _MASK
        acc[i] = (acc[i] + (keyed & 0xFFFFFFFF) * (keyed >> 32)) & _MASK


def _long(data):
    size = len(data)
    acc = [_P32[2], _P64[0], _P64[1], _P64[2], _P64[3], _P32[1], _P64[4], _P32[0]]
    blocks = (size - 1) // 1024
    for block in range(blocks):
        for stripe in range(16):
            _accumulate(acc, data, 1024 * block + 64 * stripe, 8 * stripe)
        for i in range(8):
            acc[i] = (acc[i] ^ (acc[i] >> 47) ^ _u64(_SECRET, 128 + 8 * i)) * _P32[0] & _MASK
    for stripe in range((size - 1 - 1024 * blocks) // 64):
        _accumulate(acc, data, 1024 * blocks + 64 * stripe, 8 * stripe)
    _accumulate(acc, data, size - 64, 192 - 64 - 7)
    result = size * _P64[0]
    for i in range(4):
        result += _fold(acc[2 * i] ^ _u64(_SECRET, 11 + 16 * i), acc[2 * i + 1] ^ _u64(_SECRET, 19 + 16 * i))
    return _avalanche(result & _MASK)


def xxh3_64(data):
    """The 64-bit checksum of bytes."""
    if len(data) <= 16:
        return _short(data)
    return _medium(data) if len(data) <= 240 else _long(data)
