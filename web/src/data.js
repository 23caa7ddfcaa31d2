// Bytes that the page names: in elements of the page itself, or in scripts beside it, so that it opens without a server.
const waiting = new Map();

window.radiafit_data = (name, text) => {
    waiting.get(name)?.(text);
    waiting.delete(name);
};

/** The page's own element, whole; null where there is none. The page may still be on its way. */
async function element_of(name) {
    for (;;) {
        const here = document.readyState !== "loading", element = document.getElementById(`data-${name}`);
        if (here || element?.nextSibling) return element;
        await new Promise((go) => setTimeout(go, 20));
    }
}

async function text_of(name) {
    const element = await element_of(name);
    if (element) return element.textContent;
    return new Promise((resolve, reject) => {
        waiting.set(name, resolve);
        const script = document.createElement("script");
        script.src = `data/${name}.js`;
        script.onerror = () => reject(new Error(`data/${name}.js cannot be read: is the folder whole?`));
        script.onload = () => script.remove();
        document.head.append(script);
    });
}

/** The bytes of a name, as a Uint8Array. */
export async function bytes_of(name) {
    const binary = atob(await text_of(name));
    const bytes = new Uint8Array(binary.length);
    for (let i = 0; i < binary.length; ++i) bytes[i] = binary.charCodeAt(i);
    return bytes;
}

export const floats_of = async (name) => new Float32Array((await bytes_of(name)).buffer);
export const wholes_of = async (name) => new Uint32Array((await bytes_of(name)).buffer);

/** A WebP image as its bytes are, whatever the screen's colours. */
export async function bitmap_of(name) {
    const blob = new Blob([await bytes_of(name)], { type: "image/webp" });
    return createImageBitmap(blob, { premultiplyAlpha: "none", colorSpaceConversion: "none" });
}
