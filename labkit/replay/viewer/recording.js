// Unpacks a motion from Python, which consists of integers that are differences along time.

/** The rows (N, k) of a channel {step, width, data}, or null if the channel is null. */
export function unpack(channel) {
  if (!channel) return null;
  const { step, width, order, data } = channel;
  const count = data.length / width;
  const rows = Array.from({ length: count }, () => new Array(width));
  for (let k = 0; k < width; k++) {
    const sums = new Array(order + 1).fill(0); // sums[order] adds up differences of differences
    for (let i = 0; i < count; i++) {
      sums[0] = data[k * count + i];
      for (let n = 1; n <= order; n++) sums[n] += sums[n - 1];
      rows[i][k] = sums[order] * step;
    }
  }
  return rows;
}

/** The motion with every channel unpacked. */
export function read(json) {
  const raw = typeof json === "string" ? JSON.parse(json) : json;
  const motion = { ...raw, ghosts: {} };
  for (const name of ["q", "target", "target_quaternion", "board", "board_quaternion", "path", "error", "tau", "force"]) {
    motion[name] = unpack(raw[name]);
  }
  for (const [name, channel] of Object.entries(raw.ghosts ?? {})) motion.ghosts[name] = unpack(channel);
  motion.count = motion.q.length;
  motion.time = motion.q.map((_, i) => raw.start + i * raw.period);
  motion.end = motion.time[motion.count - 1];
  return motion;
}

/** The row at a time, interpolated linearly between samples. */
export function at(motion, rows, time) {
  const x = Math.min(Math.max((time - motion.start) / motion.period, 0), motion.count - 1);
  const i = Math.min(Math.floor(x), motion.count - 2);
  if (motion.count < 2) return rows[0];
  return rows[i].map((a, k) => a + (x - i) * (rows[i + 1][k] - a));
}
