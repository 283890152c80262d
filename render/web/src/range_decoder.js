// The adaptive binary range decoder of core/progressive/lpm/range_coder.h, and its models. Behind the end of the bytes it
// reads zeros.

export class RangeDecoder {
  constructor(bytes) {
    this.bytes = bytes;
    this.at = 0;
    this.code = 0;
    this.range = 0xffffffff;
    for (let k = 0; k < 4; ++k) this.code = ((this.code << 8) | this.next()) >>> 0;
  }

  next() {
    return this.at < this.bytes.length ? this.bytes[this.at++] : 0;
  }

  bit(models, index) {
    const zero = models[index];
    const bound = (this.range >>> 11) * zero;
    let value = 0;
    if (this.code < bound) {
      this.range = bound;
      models[index] = zero + ((2048 - zero) >> 5);
    } else {
      value = 1;
      this.code -= bound;
      this.range -= bound;
      models[index] = zero - (zero >> 5);
    }
    while (this.range < 0x1000000) {
      this.range = (this.range * 256) >>> 0;
      this.code = ((this.code << 8) | this.next()) >>> 0;
    }
    return value;
  }

  direct(bits) {
    let value = 0;
    for (let k = 0; k < bits; ++k) {
      this.range = this.range >>> 1;
      let one = 0;
      if (this.code >= this.range) {
        this.code -= this.range;
        one = 1;
      }
      value = value * 2 + one;
      if (this.range < 0x1000000) {
        this.range = (this.range * 256) >>> 0;
        this.code = ((this.code << 8) | this.next()) >>> 0;
      }
    }
    return value;
  }
}

export const bitModels = (count) => new Uint16Array(count).fill(1024);

// A number of so many bits, every bit with a model that knows those above it.
export class TreeModel {
  constructor(bits) {
    this.bits = bits;
    this.node = bitModels(1 << bits);
  }
  decode(coder) {
    let at = 1;
    for (let k = 0; k < this.bits; ++k) at = at * 2 + coder.bit(this.node, at);
    return at - (1 << this.bits);
  }
}

// Any number: its length, its second bit by a model, the rest directly.
export class NumberModel {
  constructor() {
    this.length = new TreeModel(5);
    this.second = bitModels(33);
  }
  decode(coder) {
    const n = this.length.decode(coder);
    if (n < 2) return n;
    let out = 2 + coder.bit(this.second, n);
    if (n > 2) out = out * 2 ** (n - 2) + coder.direct(n - 2);
    return out;
  }
}

export class SignedModel {
  constructor() {
    this.size = new NumberModel();
  }
  decode(coder) {
    const n = this.size.decode(coder);
    if (n === 0) return 0;
    return coder.direct(1) !== 0 ? -n : n;
  }
}
