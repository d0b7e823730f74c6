// SPDX-License-Identifier: BSD-3-Clause
// What eval/packed.cpp packs.
export async function unpack(text) {
  const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// n numbers of `width` bytes from `at`: each the difference from the one `stride` before it, byte by byte apart.
export function differences(bytes, at, n, width, stride = 1) {
  const values = width === 2 ? new Uint16Array(n) : new Uint32Array(n);
  for (let i = 0; i < n; ++i) {
    let code = 0;
    for (let b = width - 1; b >= 0; --b) code = (code * 256 + bytes[at + b * n + i]) >>> 0;
    values[i] = ((code >>> 1) ^ -(code & 1)) + (i >= stride ? values[i - stride] : 0);
  }
  return values;
}
