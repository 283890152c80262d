// How fast a view of tiles follows: limits sink, and tolerances change, by a share of what is left.

// In a second all but 0.0005, in a frame at most a fifth.
export const shareOf = (seconds) => Math.min(1 - Math.exp(-7.7 * seconds), 0.2);

// The pixels of this frame on the way to others; null: there were none before.
export function approached(pixels, goal, share) {
  const next = pixels === null ? goal : pixels * (goal / pixels) ** share;
  return Math.abs(next / goal - 1) < 0.01 ? goal : next;
}
