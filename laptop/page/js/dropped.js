// Files that are chosen or dropped, also as a folder: which one is looked at.

/** The files of a drop; of a folder all that lie in it. */
export async function filesOf({ items, files }) {
  const entries = [...items].map((item) => item.webkitGetAsEntry?.()).filter(Boolean);
  if (!entries.some(({ isDirectory }) => isDirectory)) return [...files];
  const within = async (entry) => {
    if (entry.isFile) return [await new Promise((done, failed) => entry.file(done, failed))];
    const reader = entry.createReader(), all = [];
    // A reader gives some at a time, and none at the end.
    for (let some; (some = await new Promise((done, failed) => reader.readEntries(done, failed))).length;) all.push(...some);
    return (await Promise.all(all.map(within))).flat();
  };
  return (await Promise.all(entries.map(within))).flat().sort((a, b) => a.name.localeCompare(b.name));
}

/** Those of the files to open: the parts of a ROS bag together, of others the first. */
export const together = (files) => (files.some(({ name }) => name === "metadata.yaml") ? files : files.slice(0, 1));
