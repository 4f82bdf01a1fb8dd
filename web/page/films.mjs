// Films for a fake camera: Chromium plays a file of JPEG pictures in a row as a camera of 30 pictures a second, over and over.
import { closeSync, openSync, readFileSync, writeSync } from 'node:fs';

/** Writes pictures, made smaller in a browser, into one file.
 *  @param browser  of playwright, @param {string[]} pictures  files, @param {string} film  to write, .mjpeg
 *  @param {number} width, height  px; the picture is scaled to cover them */
export async function writeFilm(browser, pictures, film, width, height) {
  const page = await browser.newPage(), out = openSync(film, 'w');
  try {
    for (const picture of pictures) {
      const url = `data:image/jpeg;base64,${readFileSync(picture).toString('base64')}`;
      const jpeg = await page.evaluate(async ([url, width, height]) => {
        const image = new Image();
        image.src = url;
        await image.decode();
        const canvas = new OffscreenCanvas(width, height), context = canvas.getContext('2d');
        const scale = Math.max(width / image.width, height / image.height);
        context.imageSmoothingQuality = 'high';
        context.drawImage(image, (width - scale * image.width) / 2, (height - scale * image.height) / 2, scale * image.width, scale * image.height);
        const bytes = new Uint8Array(await (await canvas.convertToBlob({ type: 'image/jpeg', quality: 0.92 })).arrayBuffer());
        let text = '';
        for (const byte of bytes) text += String.fromCharCode(byte);
        return btoa(text);
      }, [url, width, height]);
      writeSync(out, Buffer.from(jpeg, 'base64'));
    }
  } finally {
    closeSync(out);
    await page.close();
  }
}
