// Unpacks a motion from Python, which consists of integers that are differences along time.

/** The rows (N, k) of a channel {step, width, data}, or null if the channel is null. */
export function unpack(channel) {
  if (!channel) return null;
  const { step, width, data } = channel;
  const count = data.length / width;
  const rows = Array.from({ length: count }, () => new Array(width));
  for (let k = 0; k < width; k++) {
    let change = 0, sum = 0;
    for (let i = 0; i < count; i++) rows[i][k] = step * (sum += change += data[k * count + i]);
  }
  return rows;
}

/** The motion with every channel unpacked. */
export function read(raw) {
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
  return rows[i].map((a, k) => a + (x - i) * (rows[i + 1][k] - a));
}
