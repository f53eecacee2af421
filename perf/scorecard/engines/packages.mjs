// packages.mjs  Opens a package of npm that run.py put into the folder where the driver runs.
import path from 'path';
import { pathToFileURL } from 'url';

export const file = (name) => path.join(process.cwd(), 'node_modules', name);
export const open = (name) => import(pathToFileURL(file(name)));
