// A problem told in full, in words for who sees the page.
export class Problem extends Error {}
