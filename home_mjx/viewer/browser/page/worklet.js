// Ring buffer between the network and the sound device. It plays once `delay` seconds are stored, skips when twice as
// much is stored, and drifts by at most 0.5 % towards `delay`, by linear interpolation.

const SECONDS = 4;  // [s] capacity
const MAX_DRIFT = 0.005;

class Ring extends AudioWorkletProcessor {
  constructor({ processorOptions: { delay } }) {
    super();
    this.target = delay * sampleRate;
    this.data = [new Float32Array(SECONDS * sampleRate), new Float32Array(SECONDS * sampleRate)];
    Object.assign(this, { written: 0, read: 0, isPlaying: false, gaps: 0, received: 0, blocks: 0, power: [0, 0] });
    this.port.onmessage = ({ data }) => this.write(data);
  }

  write(samples) {  // interleaved, left first
    const size = this.data[0].length;
    for (let i = 0; i < samples.length / 2; i++) {
      const place = this.written++ % size;
      this.data[0][place] = samples[2 * i];
      this.data[1][place] = samples[2 * i + 1];
    }
    this.received += samples.length / 2;
    if (this.written - this.read > 2 * this.target) this.read = this.written - this.target;
  }

  process(inputs, [output]) {
    const count = output[0].length, size = this.data[0].length;
    const stored = this.written - this.read;
    if (!this.isPlaying && stored >= this.target) this.isPlaying = true;
    if (this.isPlaying && stored < 2 * count) { this.isPlaying = false; this.gaps += 1; }
    const error = (stored - this.target) / this.target;
    const pace = 1 + MAX_DRIFT * Math.max(-1, Math.min(1, 2 * error));
    for (let i = 0; this.isPlaying && i < count; i++, this.read += pace) {
      const whole = Math.floor(this.read), rest = this.read - whole;
      for (let ear = 0; ear < 2; ear++) {
        const ring = this.data[ear];
        const value = (1 - rest) * ring[whole % size] + rest * ring[(whole + 1) % size];
        output[ear][i] = value;
        this.power[ear] += value * value;
      }
    }
    this.blocks += 1;
    if (this.blocks * count >= 0.1 * sampleRate) this.report(this.blocks * count);
    return true;
  }

  report(count) {
    const level = this.power.map((sum) => Math.sqrt(sum / count));
    const { gaps, received } = this;
    this.port.postMessage({ level, gaps, received, delay: (this.written - this.read) / sampleRate });
    this.power = [0, 0];
    this.blocks = 0;
  }
}

registerProcessor("ring", Ring);
