"""What imports read: COLMAP models, photographs, masks and meshes; images under lamps, and the lists beside them."""
import struct
import zlib

from bad_inputs.damage import GONE, append, copied, cut, field, fifo, folder, link, patch, remove, renamed, replace, write
from bad_inputs.fixtures import JPEG, exr, tiff

rows = []


def colmap(model="text", mesh="mesh.obj", more=""):
    return f"import colmap --model photos/{model} --images photos/images --mesh photos/{mesh} {more} -o new".replace("  ", " ")


def lights(images="images", vectors="lights.txt", more=""):
    return f"import lights --images lit/{images} --lights lit/{vectors} {more} -o new".replace("  ", " ")


# COLMAP's text
cameras, images = "photos/text/cameras.txt", "photos/text/images.txt"
for pattern, text, *words in (
    ("^1 PINHOLE", "1", f"{cameras}:1: camera model 16 is not a pinhole"),
    ("PINHOLE 16 16 20 20 8 8", "SIMPLE_RADIAL 16 16 20 8 8 -900", f"{cameras}: lens SIMPLE_RADIAL (-900) of image '0.png' folds the picture over", "with fewer coefficients"),
    ("PINHOLE 16 16 20 20 8 8", "OPENCV 16 16 20 20 8 8 1e300 1e300 0 0", f"{cameras}: lens OPENCV (1e+300, 1e+300, 0, 0) of image '0.png' folds"),
    ("PINHOLE 16 16 20 20 8 8", "FOV 16 16 20 20 8 8 4", f"{cameras}: lens FOV (4) of image '0.png' folds"),
    ("PINHOLE 16 16 20 20 8 8", "RAD_TAN_THIN_PRISM_FISHEYE 16 16 20 20 8 8", f"{cameras}:1: camera model RAD_TAN_THIN_PRISM_FISHEYE is not a pinhole", "`colmap image_undistorter`"),
    ("PINHOLE 16 16 20 20 8 8", "OPENCV 16 16 20 20 8 8 0 0 0", f"{cameras}:1: OPENCV takes 8 parameters, the line has 7"),
    ("PINHOLE", "OPENCV_FISHEYE", f"{cameras}:1: OPENCV_FISHEYE takes 8 parameters, the line has 4"),
    ("PINHOLE", "PINHOL", f"{cameras}:1: camera model PINHOL is not a pinhole"),
    ("20 20 8 8", "20 20 8", f"{cameras}:1: PINHOLE takes 4 parameters, the line has 3"),
    ("20 20 8 8", "20 20 8 8 0", f"{cameras}:1: PINHOLE takes 4 parameters, the line has 5"),
    ("20 20 8 8", "nan 20 8 8", f"{cameras}:1: a parameter is 'nan', which is not finite"),
    ("20 20 8 8", "20 inf 8 8", f"{cameras}:1: a parameter is 'inf', which is not finite"),
    ("20 20 8 8", "20,5 20 8 8", f"{cameras}:1: a parameter is '20,5', which is no number"),
    ("20 20 8 8", "1e999 20 8 8", f"{cameras}:1: a parameter is '1e999', which is no number"),
    ("20 20 8 8", "0 20 8 8", f"{cameras}:1: camera 1 has a focal length that is not positive"),
    ("20 20 8 8", "20 -20 8 8", f"{cameras}:1: camera 1 has a focal length that is not positive"),
    ("16 16", "0 16", f"{cameras}:1: camera 1 has size 0 x 16, outside [1, 65536]"),
    ("16 16", "16 70000", f"{cameras}:1: camera 1 has size 16 x 70000, outside [1, 65536]"),
    ("16 16", "-16 16", f"{cameras}:1: WIDTH is '-16', which is no whole number"),
    ("16 16", "16.5 16", f"{cameras}:1: WIDTH is '16.5', which is no whole number"),
    ("16 16", "16 99999999999999999999", f"{cameras}:1: HEIGHT is '99999999999999999999', which is no whole number"),
    ("16 16", "32 27", "photos/images/0.png: 16 x 16 pixels, but photos/text/cameras.txt calibrates 32 x 27", "scaled alike"),
    ("16 16", "20000 20000", "photos/images/0.png: ", "pixels"),
    ("2 PINHOLE", "1 PINHOLE", f"{cameras}:2: camera 1 is given twice"),
    ("2 PINHOLE", "4294967298 PINHOLE", f"{cameras}:2: camera 4294967298 has an id beyond 32 bits"),
    ("2 PINHOLE", "7 PINHOLE", f"{images}:3: image '1.png' refers to camera 2, which {cameras} does not hold"),
    ("3 PINHOLE.*", "", f"{images}:5: image '2.png' refers to camera 3, which {cameras} does not hold"),
):
    rows.append((colmap(), replace(cameras, pattern, text), 2, *words))
for pattern, text, *words in (
    (r"^1 \S+", "1 nan", f"{images}:1: QW is 'nan', which is not finite", "correct the line"),
    (r"^1 \S+", "1 one", f"{images}:1: QW is 'one', which is no number"),
    (r"^1 \S+ \S+ \S+ \S+", "1 0 0 0 0", f"{images}:1: image '0.png' has a zero quaternion"),
    (r"^1 \S+ \S+ \S+ \S+", "1 0 0 0", f"{images}:1: expected IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME"),
    (r"0 0 4 1", "0 0 inf 1", f"{images}:1: TZ is 'inf', which is not finite"),
    (r"0 0 4 1", "0 0 4 -1", f"{images}:1: CAMERA_ID is '-1', which is no whole number"),
    (r"0 0 4 1", "0 0 4 9", f"{images}:1: image '0.png' refers to camera 9, which {cameras} does not hold"),
    (r"0 0 4 1", "0 0 4 4294967297", f"{images}:1: image '0.png' refers to camera 4294967297"),
    (r"^1 ", "x ", f"{images}:1: IMAGE_ID is 'x', which is no whole number"),
    (r"1 0.png", "1", f"{images}:1: expected IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME"),
    (r"0.png\n", "0.png\n1 2 3 4\n#", f"{images}:2: expected the points X Y POINT3D_ID... of image '0.png', or an empty line"),
    (r"1\.png", "0.png", f"{images}: image '0.png' is given twice: remove one"),
    (r"1\.png", "gone.png", "photos/images/gone.png: no such image, but photos/text/images.txt names it (1 of 3 images are missing)"),
    (r"1\.png", "../mesh.obj", "photos/images/../mesh.obj: neither PNG, JPEG, TIFF, OpenEXR"),
    (r"1\.png", "a" * 300 + ".png", "aaaa"),
):
    rows.append((colmap(), replace(images, pattern, text), 2, *words))
rows += [
    (colmap(), write(cameras, ""), 2, f"{images}:1: image '0.png' refers to camera 1"),
    (colmap(), write(images, ""), 2, f"{images}: holds no image: register photographs first"),
    (colmap(), write(images, "# nothing\n"), 2, f"{images}: holds no image"),
    (colmap(), replace(images, r"^1 ", "# Number of images: 4, mean observations per image: 0\n1 "), 2,
     f"{images}: says that it holds 4 images, but there are 3"),
    (colmap(), replace(images, r"^1 ", "# Number of images: 3, mean observations per image: 0\n1 "), 0, "3 views"),
    (colmap(), write(cameras, "\x00\x01\x02" * 50), 2, f"{cameras}: holds zero bytes, so it is no text"),
    (colmap(), remove(cameras), 2, "photos/text: no COLMAP model here", "--model takes the folder"),
    (colmap(), remove(images), 2, "photos/text: no COLMAP model here", "--model takes the folder"),
    (colmap("nowhere"), None, 2, "photos/nowhere: no COLMAP model here"),
    (colmap("mesh.obj"), None, 2, "photos/mesh.obj: no COLMAP model here"),
    (colmap(), replace(cameras, "PINHOLE 16 16 20 20 8 8", "OPENCV 16 16 20 20 8 8 0 0 0 0"), 0, "3 views"),
    (colmap(), replace(cameras, "PINHOLE 16 16 20 20 8 8", "OPENCV 16 16 20 20 8 8 0.01 0 1e-3 0"), 0, "undistorted from OPENCV (0.01, 0, 0.001, 0): 16 x 16"),
    (colmap(), replace(cameras, "16 16 20 20 8 8", "32 32 40 40 16 16"), 0, "3 views"),
    (colmap(), None, 0, "3 views"),
]
for share in (0.02, 0.3, 0.7):
    rows.append((colmap(), cut(cameras, share), 2, "photos/text/"))
    rows.append((colmap(), cut(images, share), 2, "photos/text/images.txt"))

# COLMAP's binary files
bcameras, bimages = "photos/binary/cameras.bin", "photos/binary/images.bin"
for file in (bcameras, bimages):
    for size in (0, 4, 0.3, 0.6, -1):
        rows.append((colmap("binary"), cut(file, size), 2, f"{file}: truncated: ", "copy or write the model again"))
    rows.append((colmap("binary"), append(file, "x"), 2, f"{file}: 1 bytes follow the last entry"))
    rows.append((colmap("binary"), patch(file, 0, b"\xff" * 8), 2, f"{file}: truncated: "))
    rows.append((colmap("binary"), patch(file, 0, b"\x02"), 2, f"{file}: ", "bytes follow the last entry"))
    rows.append((colmap("binary"), remove(file), 2, "photos/binary: no COLMAP model here"))
rows += [
    (colmap("binary"), patch(bcameras, 12, b"\x0b"), 2, f"{bcameras}: camera model RAD_TAN_THIN_PRISM_FISHEYE is not a pinhole"),
    (colmap("binary"), patch(bcameras, 12, b"\xff\xff\xff\xff"), 2, f"{bcameras}: camera model number -1 is not a pinhole"),
    (colmap("binary"), patch(bcameras, 12, b"\x63"), 2, f"{bcameras}: camera model number 99 is not a pinhole"),
    (colmap("binary"), patch(bcameras, 16, b"\0" * 8), 2, f"{bcameras}: camera 1 has size 0 x 16"),
    (colmap("binary"), patch(bcameras, 16, b"\xff" * 8), 2, f"{bcameras}: camera 1 has size 18446744073709551615 x 16"),
    (colmap("binary"), patch(bcameras, 32, b"\0\0\0\0\0\0\xf8\x7f"), 2, f"{bcameras}: camera 1 has a parameter that is not finite"),
    (colmap("binary"), patch(bcameras, 8, b"\x02"), 2, f"{bcameras}: camera 2 is given twice"),
    (colmap("binary"), patch(bimages, 12, b"\0\0\0\0\0\0\xf0\x7f"), 2, f"{bimages}: image '0.png' has a pose that is not finite"),
    (colmap("binary"), patch(bimages, 12, bytes(32)), 2, f"{bimages}: image '0.png' has a zero quaternion"),
    (colmap("binary"), patch(bimages, 68, b"\x63"), 2, f"{bimages}: image '0.png' refers to camera 99"),
    (colmap("binary"), patch(bimages, 72, b"\0"), 2, f"{bimages}: "),
    (colmap("binary"), patch(bimages, 78, b"\xff" * 8), 2, f"{bimages}: truncated: "),
    (colmap("binary"), None, 0, "3 views"),
]

# Other calibrations: transforms.json of a NeRF, poses_bounds.npy of LLFF
transforms, poses = "photos/transforms.json", "photos/poses_bounds.npy"


def calibrated(kind, model="photos", more=""):
    return f"import {kind} --model {model} --mesh photos/mesh.obj {more} -o new".replace("  ", " ")


for damage, *words in (
    (remove(transforms), "photos: neither transforms.json nor transforms_train.json is here: check --model"),
    (folder(transforms), f"{transforms}: cannot read this file of cameras: it is a folder"),
    (fifo(transforms), f"{transforms}: cannot read this file of cameras: it is a pipe"),
    (write(transforms, ""), f"{transforms}: truncated, or no JSON"),
    (write(transforms, "[]"), f'{transforms}: has no list of "frames"'),
    (write(transforms, "[" * 10000), f"{transforms}: its brackets are nested more than 100 deep"),
    (write(transforms, '{"frames": []}'), f"{transforms}: holds no image"),
    (replace(transforms, '"w": 16', '"w": NaN'), f"{transforms}: truncated, or no JSON (which has no NaN)"),
    (field(transforms, "k1", -900), f"{transforms}: lens OPENCV (k1 -900) of image '", "folds the picture over"),
    (field(transforms, "frames[2].p1", "x"), f'{transforms}: frames[2]: "p1" must be a number'),
    (field(transforms, "camera_model", "EQUIRECTANGULAR"), f"{transforms}: frames[0]: camera model EQUIRECTANGULAR is not read: undistort"),
    (field(transforms, "distortion_params", [0.1]), f'{transforms}: frames[0]: "distortion_params" must be 6 numbers'),
    (field(transforms, "fl_x", GONE), f'{transforms}: frames[0]: neither "fl_x" nor "camera_angle_x" is given'),
    (field(transforms, "fl_x", 0), f'{transforms}: frames[0]: "fl_x" is 0, not positive'),
    (field(transforms, "fl_x", "20"), f'{transforms}: frames[0]: "fl_x" must be a number'),
    (field(transforms, "fl_x", 1e300), f"{transforms}: frames[0]: the focal lengths"),
    (field(transforms, "w", 1e300), f'{transforms}: frames[0]: "w" is 1e+300, no whole number from 1 to 65536'),
    (field(transforms, "w", 32), f"photos/images/0.png: 16 x 16 pixels, but {transforms} calibrates 32 x 16: give the photographs that were calibrated", "--max-size"),
    (field(transforms, "frames[1].file_path", GONE), f'{transforms}: frames[1]: "file_path" must be a text'),
    (field(transforms, "frames[1].file_path", "images/7"), f"photos/images/7: no such image, but {transforms} names it (1 of 3 images are missing): check --images"),
    (field(transforms, "frames[1].file_path", "images/0.png"), f"{transforms}: image 'images/0.png' is given twice"),
    (field(transforms, "frames[1].file_path", "a" * 300), "aaaa"),
    (field(transforms, "frames[1].file_path", "mesh.obj"), "photos/mesh.obj: neither PNG, JPEG, TIFF, OpenEXR"),
    (field(transforms, "frames[1].mask_path", "masks/9.png"), f"photos/masks/9.png: no such mask, but {transforms}: frames[1] names it"),
    (field(transforms, "frames[1].transform_matrix", [[1, 0, 0, 0]]), f'{transforms}: frames[1]: "transform_matrix" must be 4 rows of 4 numbers'),
    (field(transforms, "frames[1].transform_matrix[0][0]", 3), f"{transforms}: frames[1]: the pose's first three columns are no rotation"),
    (field(transforms, "frames[1].transform_matrix[0][3]", None), f'{transforms}: frames[1]: "transform_matrix" must be a number'),
    (field(transforms, "frames[1].transform_matrix[0][3]", 1e300), f"{transforms}: frames[1]: the translation"),
    (copied(transforms, "photos/transforms_test.json"), f"{transforms}: all its images are held out and none is left to fit: give --holdout"),
    (write("photos/transforms_test.json", "{"), "photos/transforms_test.json: truncated, or no JSON"),
):
    rows.append((calibrated("transforms"), damage, 2, *words))
for size in (0.1, 0.5, 0.9, -1):
    rows.append((calibrated("transforms"), cut(transforms, size), 2, f"{transforms}: truncated, or no JSON"))
    rows.append((calibrated("llff"), cut(poses, size), 2, f"{poses}: ", "numpy.save"))
for damage, *words in (
    (remove(poses), f"{poses}: missing array file"),
    (folder(poses), f"{poses}: no file"),
    (write(poses, ""), f"{poses}: no array of numpy.save, or cut"),
    (append(poses, "x"), f"{poses}: too long: 409 bytes follow its header, not the 408 of its shape (3, 17)"),
    (replace(poses, "<f8", ">f8"), f"{poses}: big-endian"),
    (replace(poses, "3, 17", "17, 3"), f"{poses}: its shape is (17, 3), which should be (images, 17)"),
    (replace(poses, r"\(3, 17\)", "(51,)  "), f"{poses}: its shape is (51,), which should be (images, 17)"),
    (patch(poses, 8, b"\xff\xff"), f"{poses}: its header is damaged"),
    (patch(poses, 128, b"\0\0\0\0\0\0\xf8\x7f"), f"{poses}: row 0, image '0.png': the pose is not finite"),
    (patch(poses, 128 + 32, bytes(8)), f"{poses}: row 0, image '0.png': the height is 0, no whole number from 1 to 65536"),
    (patch(poses, 128 + 8 * 14, bytes(8)), f"{poses}: row 0, image '0.png': the focal lengths 0 and 0"),
    (patch(poses, 128, bytes(8 * 3)), f"{poses}: row 0, image '0.png': the pose's first three columns are no rotation"),
    (remove("photos/images/1.png"), f"{poses}: has 3 rows, but photos/images holds 2 images"),
    (copied("photos/images/1.png", "photos/images/9.jpg"), f"{poses}: has 3 rows, but photos/images holds 4 images"),
):
    rows.append((calibrated("llff"), damage, 2, *words))
rows += [
    (calibrated("llff", more="--images photos/nowhere"), None, 2, "photos/nowhere: no such folder of photographs: check --images"),
    (calibrated("transforms", more="--images photos/nowhere"), None, 2, "photos/nowhere: no such folder of photographs"),
    (calibrated("transforms", more="--max-size 8 --masks photos/masks"), None, 0, "3 views", "masks are named NAME.png, without subfolders"),
    (calibrated("transforms", transforms, "--images photos/images --holdout every:3"), copied(transforms, "photos/transforms_test.json"), 0, "3 views", "photos/transforms_test.json is not read: --holdout says"),
    (calibrated("transforms"), field(transforms, "frames[1].mask_path", "masks/1.png"), 0, "3 views"),
    (calibrated("llff", poses, "--gains estimate --least-coverage 0.1"), None, 0, "3 views"),
]

# Photographs and masks
photo = "photos/images/1.png"
for size in (0, 4, 8, 0.3, 0.7, -8, -20):
    rows.append((colmap(), cut(photo, size), 2, f"{photo}: truncated or corrupt image", "copy or export it again"))
rows += [
    (colmap(), remove(photo), 2, f"{photo}: no such image, but {images} names it (1 of 3 images are missing)", "check --images", "--skip-missing"),
    (colmap(), folder(photo), 2, f"{photo}: cannot read this image file: it is a folder"),
    (colmap(), write(photo, "no picture"), 2, f"{photo}: neither PNG, JPEG, TIFF, OpenEXR"),
    (colmap(), patch(photo, 45, b"\xff"), 2, f"{photo}: truncated or corrupt image (PNG checksum differs)"),
    (colmap(), patch(photo, 2, b"\xff"), 2, f"{photo}: neither PNG, JPEG, TIFF, OpenEXR"),
    (colmap(), patch(photo, 5, b"\xff"), 2, f"{photo}: truncated or corrupt image (PNG signature differs)"),
    (colmap(), copied("lit/images/0.png", photo), 2, f"{photo}: 6 x 5 pixels, but {cameras} calibrates 16 x 16"),
    (colmap(), write(photo, JPEG), 2, f"{photo}: 6 x 5 pixels, but {cameras} calibrates 16 x 16"),
    (colmap(), write(photo, b"\0\0\0\x1cftypheic"), 2, f"{photo}: truncated or corrupt image"),
    (colmap(), write(photo, b"RIFF1234WEBPVP8 "), 2, f"{photo}: a WebP picture, which is not read: convert it to PNG (dwebp"),
    (colmap(), write(photo, b"FUJIFILMCCD-RAW"), 2, f"{photo}: a camera's raw picture (RAF), which is not read: develop it"),
    (colmap(), write(photo, b"\xff\xd8\xff\xc0\0\x14\x08\0\x08\0\x08\4" + bytes(60)), 2, f"{photo}: a JPEG of CMYK colours"),
    (colmap(), write(photo, exr(16, 16, [0.5] * 768)), 0, "3 views", "1 of 3 pictures, such as 1.png: OpenEXR of floats: linear light", "f32-linear"),
    (colmap(more="--exif-orientation apply"), None, 0, "3 views"),
    (colmap(more="--exif-orientation left"), None, 2, "--exif-orientation"),
    (colmap(more="--images photos/nowhere").replace("--images photos/images ", ""), None, 2, "photos/nowhere: no such folder of photographs: check --images"),
    (colmap(more="--masks photos/nowhere"), None, 2, "photos/nowhere: no such folder of masks: check --masks"),
    (colmap(more="--masks photos/masks"), remove("photos/masks/1.png"), 2, "photos/masks: no mask for image '1.png' (1 of 3 images have none): expected 1.png, as '0.png' has 0.png"),
    (colmap(more="--masks photos/masks"), renamed("photos/masks/1.png", "photos/masks/mask_1.PNG"), 2, "no mask for image '1.png'", "mask_1.PNG is named otherwise: name all alike"),
    (colmap(more="--masks photos/masks"), copied("photos/masks/1.png", "photos/masks/1.PNG"), 2, "photos/masks/1.PNG and photos/masks/1.png may both be the mask of image '1.png'"),
    (colmap(more="--masks photos/masks"), copied("photos/masks/1.png", "photos/masks/1_mask.png"), 0, "1 masks that are named NAME_mask.png are left aside, such as 1_mask.png"),
    (colmap(more="--masks photos/binary"), None, 2, "photos/binary: no mask for any image: expected, for image '0.png', 0.png, 0.png.png, 0_mask.png, 0.mask.png or mask_0.png"),
    (colmap(more="--masks photos/images"), None, 2, "photos/images: no mask for any image"),
    (colmap(more="--masks photos/masks"), cut("photos/masks/1.png", 0.5), 2, "photos/masks/1.png: truncated or corrupt image"),
    (colmap(more="--masks photos/masks"), copied("lit/mask.png", "photos/masks/1.png"), 2, "photos/masks/1.png: 6 x 5 pixels, but "),
    (colmap(more="--masks photos/masks"), None, 0, "3 views"),
    (colmap(more="--max-size 8"), None, 0, "3 views"),
]

# Gains and held-out lists
gains = "photos/gains.txt"
for damage, *words in (
    (write(gains, ""), f"{gains}: no gain for image '0.png': add a line NAME GAIN for it"),
    (write(gains, "0.png 1\n1.png 1\n"), f"{gains}: no gain for image '2.png'"),
    (write(gains, "0.png\n"), f"{gains}:1: expected an image name and, in the last column, its linear gain"),
    (replace(gains, "0.png 1", "0.png 0"), f"{gains}:1: the gain 0 is not from 1e-06 to 1e+06: correct the line"),
    (replace(gains, "0.png 1", "0.png -1"), f"{gains}:1: the gain -1 is not from 1e-06 to 1e+06"),
    (replace(gains, "0.png 1", "0.png 1e30"), f"{gains}:1: the gain 1e+30 is not from"),
    (replace(gains, "0.png 1", "0.png 1e-7"), f"{gains}:1: the gain 1e-07 is not from"),
    (replace(gains, "0.png 1", "0.png nan"), f"{gains}:1: the gain in the last column is 'nan', which is not finite"),
    (replace(gains, "0.png 1", "0.png one"), f"{gains}:1: the gain in the last column is 'one', which is no number"),
    (replace(gains, "1.png", "0.png"), f"{gains}:2: image '0.png' is given twice: remove one line"),
    (folder(gains), f"{gains}: cannot read this gain table"),
    (remove(gains), f"{gains}: no such gain table"),
):
    rows.append((colmap(more=f"--gains {gains}"), damage, 2, *words))
rows += [
    (colmap(more=f"--gains {gains}"), None, 0, "gains"),
    (colmap(more="--gains estimate"), None, 0, "gains"),
    (colmap(more="--gains auto"), None, 0, "applied"),
    (colmap(more="--holdout photos/held.txt"), write("photos/held.txt", "9.png\n"), 2, "photos/held.txt:1: no image is named '9.png': write one name per line"),
    (colmap(more="--holdout photos/held.txt"), write("photos/held.txt", "0.png\n1.png\n2.png\n"), 2, "--holdout photos/held.txt: holds out all 3 images"),
    (colmap(more="--holdout photos/held.txt"), write("photos/held.txt", "1.png\n"), 0, "1 of them held out"),
    (colmap(more="--holdout photos/held.txt"), write("photos/held.txt", ""), 2, "photos/held.txt: names no image: write one per line, or --holdout none"),
    (colmap(more="--holdout photos/held.txt"), write("photos/held.txt", "# none\n\n"), 2, "photos/held.txt: names no image"),
    (colmap(more="--holdout none"), None, 0, "0 of them held out"),
]

# Meshes
rows += [
    (colmap(mesh="none.ply"), None, 2, "photos/none.ply: no such mesh file", "check the path"),
    (colmap(mesh="images"), None, 2, "photos/images: cannot read this mesh file: it is a folder"),
    (colmap(mesh="mesh.obj"), write("photos/mesh.obj", ""), 2, "photos/mesh.obj: empty mesh"),
    (colmap(mesh="binary.ply"), write("photos/binary.ply", ""), 2, "photos/binary.ply: empty mesh"),
    (colmap(mesh="mesh.obj"), write("photos/mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n"), 2, "photos/mesh.obj: "),
    (colmap(mesh="mesh.obj"), write("photos/mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nl 1 2 3\n"), 2, "photos/mesh.obj: "),
    (colmap(mesh="mesh.obj"), write("photos/mesh.obj", "v 0 0 9000\nv 1 0 9000\nv 0 1 9000\nf 1 2 3\n"), 2, "photos/mesh.obj: no camera of photos/text sees this mesh"),
    (colmap(mesh="mesh.obj"), write("photos/mesh.obj", "v 49 -1 0\nv 51 -1 0\nv 51 1 0\nv 49 1 0\nf 1 2 3\nf 1 3 4\n"), 2,
     "photos/mesh.obj: no camera of photos/text sees this mesh; shifted", "--mesh-shift -50,", "it has another origin"),
    (colmap(more="--masks photos/masks"), write("photos/mesh.obj", "v -1e-2 -1e-2 0\nv 1e-2 -1e-2 0\nv 1e-2 1e-2 0\nv -1e-2 1e-2 0\nf 1 2 3\nf 1 3 4\n"), 2,
     "photos/mesh.obj: ", "scaled by 1000 it would cover", "it has another unit", "--least-coverage"),
    (colmap(mesh="ascii.ply"), None, 0, "2 triangles"),
    (colmap(mesh="binary.ply"), None, 0, "2 triangles"),
]

for mesh in ("binary.ply", "ascii.ply"):
    path = f"photos/{mesh}"
    for share in (0.05, 0.2, 0.4, 0.6, 0.7, 0.8, 0.9, 0.95, -2 if mesh == "ascii.ply" else -1):
        rows.append((colmap(mesh=mesh), cut(path, share), 2, path))
    for pattern, text in (
        ("vertex 4", "vertex 3"), ("vertex 4", "vertex 4000000000"), ("vertex 4", "vertex -4"), ("vertex 4", "vertex 99999999999999999999"),
        ("face 2", "face 3"), ("face 2", "face 4000000000"), ("face 2", "face 0"), ("property float z\n", ""), ("float z", "flot z"),
        ("vertex_indices", "elsewhere"), ("ply", "pla"), (" 1.0", " 7.0"), ("end_header", "no_header"), ("format \\S+", "format binary"),
    ):  # fmt: skip
        rows.append((colmap(mesh=mesh), replace(path, pattern, text), 2, path))
for index in (4, -1, 2**31 - 1):
    rows.append((colmap(mesh="binary.ply"), patch("photos/binary.ply", -4, struct.pack("<i", index)), 2, f"refers to vertex {index}"))
rows += [
    (colmap(mesh="binary.ply"), patch("photos/binary.ply", -13, b"\xff"), 2, "photos/binary.ply: "),
    (colmap(mesh="binary.ply"), patch("photos/binary.ply", -30, b"\0\0\xc0\x7f"), 2, "photos/binary.ply: ", "its position is not finite"),
    (colmap(mesh="ascii.ply"), replace("photos/ascii.ply", "vertex 4", "vertex 5"), 2, "photos/ascii.ply:14: more numbers than the header has properties"),
    (colmap(mesh="ascii.ply"), replace("photos/ascii.ply", "3 0 2 3", "3 0 2 4"), 2, "photos/ascii.ply:15: refers to vertex 4"),
    (colmap(mesh="ascii.ply"), replace("photos/ascii.ply", "3 0 2 3", "3 0 2 -1"), 2, "photos/ascii.ply:15: refers to vertex -1"),
    (colmap(mesh="ascii.ply"), replace("photos/ascii.ply", "3 0 2 3", "9 0 2 3"), 2, "photos/ascii.ply:15: fewer numbers"),
    (colmap(mesh="ascii.ply"), replace("photos/ascii.ply", "3 0 2 3", "3 0 two 3"), 2, "photos/ascii.ply:15: a value is 'two'"),
    (colmap(mesh="ascii.ply"), replace("photos/ascii.ply", "-1 -1 0", "-1 nan 0"), 2, "photos/ascii.ply:10: a value is 'nan', which is not finite"),
    (colmap(mesh="mesh.off"), write("photos/mesh.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"), 2, "photos/mesh.off: neither PLY, OBJ, STL, GLB nor glTF"),
    (colmap(), write("photos/mesh.obj", "\0" * 1000), 2, "photos/mesh.obj"),
]
for pattern, text in (("f 1 3 4", "f 1 3 5"), ("f 1 3 4", "f 1 3 0"), ("f 1 3 4", "f 1 3 -5"), ("f 1 3 4", "f 1 3 four"),
                      ("f 1 3 4", "f 1 3 99999999999999999999"), ("f 1 3 4", "f 1/ 3/ /4"), ("v -1 -1 0", "v -1 -1"),
                      ("v -1 -1 0", "v -1 nan 0"), ("v -1 -1 0", "v -1 1e999 0"), ("v -1 -1 0", "v one -1 0")):  # fmt: skip
    rows.append((colmap(), replace("photos/mesh.obj", pattern, text), 2, "photos/mesh.obj:"))

# Lists of lights
vectors, lp = "lit/lights.txt", "lit/dome.lp"
for damage, *words in (
    (remove(vectors), f"{vectors}: no such list of lights"),
    (folder(vectors), f"{vectors}: cannot read this list of lights"),
    (write(vectors, ""), f"{vectors}: 0 lights, but lit/images holds 4 images"),
    (append(vectors, "0 0 1\n"), f"{vectors}: 5 lights, but lit/images holds 4 images", "write one line per image"),
    (replace(vectors, "0 0 1", "0 0"), f"{vectors}:1: a light takes three numbers, here are 2"),
    (replace(vectors, "0 0 1", "0 0 1 1"), f"{vectors}:1: a light takes three numbers, here are 4"),
    (replace(vectors, "0 0 1", "0 0 up"), f"{vectors}:1: light is 'up', which is no number"),
    (replace(vectors, "0 0 1", "0 0 nan"), f"{vectors}:1: light is 'nan', which is not finite"),
    (replace(vectors, "0 0 1", "0 0 0"), f"{vectors}:1: the light's vector (0, 0, 0) has length 0", "calibrate it"),
    (replace(vectors, "0 0 1", "1e308 1e308 1e308"), f"{vectors}:1: the light's vector (1e+308, 1e+308, 1e+308) has length 1.73205e+308"),
    (replace(vectors, "0 0 1", "1e-308 0 1e-308"), f"{vectors}:1: the light's vector (1e-308, 0, 1e-308) has length "),
):
    rows.append((lights(), damage, 2, *words))
for damage, *words in (
    (remove(lp), f"{lp}: no such RTI light file"),
    (write(lp, ""), f"{lp}:0: the file is empty"),
    (replace(lp, "^4", "3"), f"{lp}: says 3 images, but lists 4"),
    (replace(lp, "^4", "99999999999999999999"), f"{lp}:1: the number of images is '99999999999999999999', which is no whole number"),
    (replace(lp, "^4", "-4"), f"{lp}:1: the number of images is '-4', which is no whole number"),
    (replace(lp, "^4", "four"), f"{lp}:1: the number of images is 'four', which is no whole number"),
    (replace(lp, "0.png 0 0 1", "0.png 0 0"), f"{lp}:2: an .lp file's line takes an image's name and three numbers"),
    (replace(lp, "0.png 0 0 1", "0.png 0 0 z"), f"{lp}:2: light direction is 'z', which is no number"),
    (replace(lp, "0.png 0 0 1", "0.png 0 0 0"), f"{lp}:2: the light's vector (0, 0, 0) has length 0"),
    (replace(lp, "1.png", "0.png"), f"{lp}:3: image '0.png' appears a second time"),
    (replace(lp, "1.png", "9.png"), "lit/images/9.png: no such image, but lit/dome.lp names it"),
    (cut(lp, 0.5), f"{lp}"),
    (cut(lp, 0.9), f"{lp}"),
):
    rows.append((lights(vectors="dome.lp"), damage, 2, *words))
places = "import lights --images lit/images --light-positions lit/places.txt --camera-positions lit/eyes.txt --sample-width 6 -o new"
for command, damage, *words in (
    (places, replace("lit/eyes.txt", "12", "0"), "lit/eyes.txt: the camera at (0, 0, 0) doesn't stand in front of the sample"),
    (places, replace("lit/eyes.txt", "12", "-3"), "lit/eyes.txt: the camera at (0, 0, -3) doesn't stand in front"),
    (places, append("lit/eyes.txt", "0 0 12\n"), "lit/eyes.txt: 2 camera positions, but there are 4 images"),
    (places, write("lit/eyes.txt", ""), "lit/eyes.txt: 0 camera positions, but there are 4 images"),
    (places, replace("lit/eyes.txt", "12", "far"), "lit/eyes.txt:1: camera position is 'far', which is no number"),
    (places, replace("lit/places.txt", "0 0 10", "0 0 0"), "lit/places.txt:1: the light's vector (0, 0, 0) has length 0"),
    (places, replace("lit/places.txt", "0 0 10", "0 0 1e13"), "lit/places.txt:1: the light's vector (0, 0, 10000000000000) has length 1e+13"),
    (lights(more="--intensities lit/intensities.txt"), write("lit/intensities.txt", "1e308\n"), "lit/intensities.txt:1: the light's intensity is 1e+308 in a channel; give 0, or 1e-12 to 1e+12"),
    (lights(more="--intensities lit/intensities.txt"), write("lit/intensities.txt", "1 1e-30 1\n"), "lit/intensities.txt:1: the light's intensity is 1e-30 in a channel"),
    (places, remove("lit/places.txt"), "lit/places.txt: no such list of lights"),
    (places, remove("lit/eyes.txt"), "lit/eyes.txt: no such list, one camera position per line"),
    (lights(more="--names lit/names.txt"), replace("lit/names.txt", "1.png", "0.png"), "lit/names.txt:2: image '0.png' appears a second time"),
    (lights(more="--names lit/names.txt"), replace("lit/names.txt", "1.png", "9.png"), "lit/images/9.png: no such image, but lit/names.txt names it"),
    (lights(more="--names lit/names.txt"), replace("lit/names.txt", "3.png\n", ""), "lit/lights.txt: 4 lights, but lit/names.txt names 3 images"),
    (lights(more="--names lit/names.txt"), write("lit/names.txt", ""), "no images here"),
    (lights(more="--names lit/names.txt"), remove("lit/names.txt"), "lit/names.txt: no such list of image names"),
    (lights(more="--intensities lit/intensities.txt"), append("lit/intensities.txt", "1\n"), "lit/intensities.txt: 2 intensities, but there are 4 images"),
    (lights(more="--intensities lit/intensities.txt"), write("lit/intensities.txt", ""), "lit/intensities.txt: 0 intensities"),
    (lights(more="--intensities lit/intensities.txt"), write("lit/intensities.txt", "0 0 0\n"), "lit/intensities.txt:1: the light's intensity is 0 in every channel; leave the image out"),
    (lights(more="--intensities lit/intensities.txt"), write("lit/intensities.txt", "1 -1 1\n"), "lit/intensities.txt:1: the light's intensity is -1 in a channel"),
    (lights(more="--intensities lit/intensities.txt"), write("lit/intensities.txt", "1 1\n"), "lit/intensities.txt:1: a light intensity takes three numbers, here are 2"),
    (lights(more="--intensities lit/intensities.txt"), write("lit/intensities.txt", "inf\n"), "lit/intensities.txt:1: the intensity is 'inf', which is not finite"),
    (lights(more="--mask lit/mask.png"), remove("lit/mask.png"), "lit/mask.png: no such image file"),
    (lights(more="--mask lit/mask.png"), cut("lit/mask.png", 0.5), "lit/mask.png: truncated or corrupt image"),
    (lights(more="--mask lit/mask.png"), copied("photos/masks/0.png", "lit/mask.png"), "lit/mask.png: 16 x 16 pixels, but the images have 6 x 5"),
    (lights(more="--mask lit/mask.png"), write("lit/mask.png", tiff(6, 5, bytes(90))), "lit/mask.png: the mask is black throughout"),
    (lights(more="--normals lit/normals.pfm"), remove("lit/normals.pfm"), "lit/normals.pfm: no such image file"),
    (lights(more="--normals lit/normals.pfm"), copied("photos/images/0.png", "lit/normals.pfm"), "lit/normals.pfm"),
    (lights(more="--normals lit/normals.pfm"), patch("lit/normals.pfm", -4, b"\0\0\xc0\x7f"), "lit/normals.pfm: the normal at column 5, row 0 is not finite"),
    (lights(more="--normals lit/normals.pfm"), patch("lit/normals.pfm", 12, bytes(360)), "lit/normals.pfm: no pixel has a normal"),
):
    rows.append((command, damage, 2, *words))
rows.append((lights(more="--mask lit/mask.png --normals lit/normals.pfm --intensities lit/intensities.txt --names lit/names.txt"), None, 0, "6 x 5"))
rows.append((lights(more="--max-size 3 --mask lit/mask.png --normals lit/normals.pfm"), None, 0, "3 x 3"))
rows.append((lights(more="--holdout none"), None, 0, "no normals given: computed from 4 training images"))
rows.append((lights(more="--normals flat"), None, 0, "6 x 5"))
rows.append((lights(more="--holdout none"), write(vectors, "0 0 1\n1 0 1\n-1 0 1\n2 0 1\n"), 0, "all in one plane", "give --normals"))
rows.append((places, None, 0, "6 x 5", "lit/eyes.txt: one line, taken for all 4 images"))

# Circles of glossy spheres
circles = "lit/circles.txt"
spheres = f"import lights --images lit/images --spheres {circles} -o new"
rows += [
    (spheres, None, 2, f"{circles}: no such list of circles"),
    (spheres, folder(circles), 2, f"{circles}: cannot read this list of circles"),
]
for text, *words in (
    ("", f"{circles}: holds no circle", "write x, y and radius"),
    ("# x y radius\n", f"{circles}: holds no circle"),
    ("3 2\n", f"{circles}:1: a circle takes three numbers, here are 2"),
    ("3 2 wide\n", f"{circles}:1: circle is 'wide', which is no number"),
    ("3 2 nan\n", f"{circles}:1: circle is 'nan', which is not finite"),
    ("3 2 2\n3 2 0\n", f"{circles}:2: the circle's radius is 0: write x, y and a radius above 0"),
    ("3 2 -1\n", f"{circles}:1: the circle's radius is -1"),
    ("9 2 2\n", f"{circles}:1: the circle at (9, 2) of radius 2 is not within the images' 6 x 5 pixels", "top left corner"),
    ("3 2 40\n", f"{circles}:1: the circle at (3, 2) of radius 40 is not within"),
    ("3 2 2\n2 2 2\n", f"{circles}:2: the circle at (2, 2) overlaps the one at (3, 2): write each sphere once"),
    ("3 2 2\n", f"{circles}: no outline of a sphere is seen near the circle at (3, 2) of radius 2"),
):
    rows.append((spheres, write(circles, text), 2, *words))
rows += [
    ("import lights --images lit/images --spheres auto -o new", None, 2, "lit/images: no glossy sphere was found in these images: say where one is (--spheres FILE", "or give the lamps (--lights)"),
    ("import lights --images lit/pfm --spheres auto:3 -o new", None, 2, "lit/pfm: no glossy sphere was found"),
    ("import lights --images lit/images --spheres auto --sample-width 6 --camera-positions lit/eyes.txt -o new", append("lit/eyes.txt", "0 0 12\n"), 2, "lit/eyes.txt: 2 camera positions, but spheres (--spheres) are seen by a camera that stands still"),
    ("import lights --images lit/images --spheres auto --sample-width 6 --camera-positions lit/eyes.txt -o new", write("lit/eyes.txt", "0 0 -12\n"), 2, "lit/eyes.txt: the camera at (0, 0, -12) doesn't stand in front"),
]

# Images under lamps, in every format
for kind, ending in (("images", "png"), ("pfm", "pfm"), ("exr", "exr"), ("tif", "tif"), ("jpg", "jpg")):
    rows.append((lights(kind), None, 0, "6 x 5"))
    second = f"lit/{kind}/2.{ending}"
    for size in (0, 4, 0.3, 0.9):
        rows.append((lights(kind), cut(second, size), 2, f"{second}: truncated or corrupt image"))
    rows.append((lights(kind), remove(second), 2, f"{vectors}: 4 lights, but lit/{kind} holds 3 images"))
    rows.append((lights(kind), write(second, "no picture"), 2, f"{second}: neither PNG, JPEG, TIFF, OpenEXR"))
    rows.append((lights(kind), cut(f"lit/{kind}/0.{ending}", 0.4), 2, f"lit/{kind}/0.{ending}: truncated or corrupt image"))
rows += [
    (lights("nowhere"), None, 2, "lit/nowhere: no such folder of images: check --images"),
    (lights("lights.txt"), None, 2, "lit/lights.txt: no such folder of images"),
    (lights(), copied("photos/images/0.png", "lit/images/2.png"), 2, "lit/images/2.png: ", "16 x 16"),
    (lights(), renamed("lit/images/2.png", "lit/images/2.txt"), 2, f"{vectors}: 4 lights, but lit/images holds 3 images"),
    (lights("pfm"), patch("lit/pfm/2.pfm", -4, b"\0\0\xc0\x7f"), 2, "lit/pfm/2.pfm: the pixel at column 5, row 0 is not finite", "repair the image"),
    (lights("exr"), patch("lit/exr/2.exr", -4, b"\0\0\x80\x7f"), 2, "lit/exr/2.exr: the pixel at column 5, row 4 is not finite"),
    (lights("exr"), write("lit/exr/2.exr", exr(5, 6, [0.5] * 90)), 2, "lit/exr/2.exr: ", "5 x 6"),
    (lights("tif"), write("lit/tif/2.tif", tiff(5, 6, bytes(90))), 2, "lit/tif/2.tif: ", "5 x 6"),
    (lights("jpg"), write("lit/jpg/2.jpg", JPEG[:-30] + bytes(30)), 2, "lit/jpg/2.jpg: truncated or corrupt image"),
    (lights(), link("lit/images/2.png", "nowhere.png"), 2, f"{vectors}: 4 lights, but lit/images holds 3 images"),
]

# Images that claim to be large: nothing of that size is to be taken before it is compared with what is known.


def png_head(width, height):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(bytes(100))) + chunk(b"IEND", b"")


large_tiff = tiff(6, 5, bytes(90))
for tag, size in ((256, 6), (257, 5), (278, 5)):
    large_tiff = large_tiff.replace(struct.pack("<HHII", tag, 3, 1, size), struct.pack("<HHII", tag, 4, 1, 40000))
bmp = b"BM" + struct.pack("<IHHIIiiHHIIiiII", 1500, 0, 0, 54, 40, 50000, 50000, 1, 24, 0, 0, 0, 0, 0, 0) + bytes(1400)
gif = b"GIF89a" + struct.pack("<HHBBB", 6, 5, 0x80, 0, 0) + bytes([0, 0, 0, 255, 255, 255]) + b"\x2c" + bytes(8) + b"\2\x16\0;"
exr_size, large = "\x05\x00\x00\x00\x04\x00\x00\x00", "\x80\x3e\x00\x00\x80\x3e\x00\x00"  # of a window: 6 x 5, 16001 x 16001
for command, damage in (
    (colmap(), write(photo, png_head(20000, 20000))), (colmap(), write(photo, png_head(2**31 - 1, 2**31 - 1))),
    (colmap(), write(photo, large_tiff)), (colmap(), write(photo, bmp)),
    (colmap(more="--masks photos/masks"), write("photos/masks/1.png", png_head(20000, 20000))),
    (colmap(more="--masks photos/masks"), write("photos/masks/1.png", gif)),
    (lights("tif"), write("lit/tif/2.tif", large_tiff)), (lights("tif"), write("lit/tif/0.tif", large_tiff)),
    (lights(), write("lit/images/2.png", png_head(20000, 20000))), (lights(), write("lit/images/0.png", png_head(60000, 60000))),
    (lights("pfm"), replace("lit/pfm/2.pfm", "6 5", "60000 50000")), (lights("pfm"), replace("lit/pfm/0.pfm", "6 5", "2147483647 2147483647")),
    (lights("pfm"), replace("lit/pfm/2.pfm", "6 5", "-6 5")), (lights("pfm"), replace("lit/pfm/2.pfm", "6 5", "0 5")),
    (lights("exr"), patch("lit/exr/2.exr", 0, b"\x76\x2f\x31\x02")), (lights("exr"), replace("lit/exr/2.exr", exr_size, large)),
):  # fmt: skip
    rows.append((command, damage, 2, damage.path))

# Numbers beyond what a camera can have
for place, old, new, *words in (
    (cameras, "20 20 8 8", "1e308 20 8 8", "the focal lengths 1e+308 and 20 "),
    (cameras, "20 20 8 8", "20 20 1e300 8", "the principal point 1e+300, 8 "),
    (images, "0 0 4 1", "0 0 1e300 1", f"{images}:1: "),
    (images, r"^1 \S+ \S+", "1 1e200 1e200", f"{images}:1: "),
    (images, r"^1 \S+ \S+ \S+ \S+", "1 1e-200 0 0 0", f"{images}:1: "),
):
    rows.append((colmap(), replace(place, old, new), 2, *words))
rows.append((lights(vectors="dome.lp"), write("lit/dome.lp", "2\na/0.png 0 0 1\nb/0.png 0.6 0 0.8\n"), 2, "lit/dome.lp"))

# A last line without a line break is taken, with a warning; what does not parse then is said to be cut.
whole = "no line break ends this last line: taken as whole"
rows += [
    (colmap(), cut(cameras, -1), 0, f"{cameras}:3: {whole}"),
    (colmap(), cut(cameras, -12), 2, f"{cameras}:3: the file ends within this line"),
    (colmap(more=f"--gains {gains}"), cut(gains, -1), 0, f"{gains}:3: {whole}"),
    (colmap(more=f"--gains {gains}"), cut(gains, -4), 2, f"{gains}:3: the file ends within this line"),
    (colmap(more="--holdout photos/held.txt"), write("photos/held.txt", "1.png"), 0, f"photos/held.txt:1: {whole}"),
    (colmap(mesh="ascii.ply"), cut("photos/ascii.ply", -1), 0, f"photos/ascii.ply:15: {whole}"),
    (colmap(mesh="ascii.ply"), cut("photos/ascii.ply", -3), 2, "photos/ascii.ply:15: the file ends within this line"),
    (lights(), cut(vectors, -1), 0, f"{vectors}:4: {whole}"),
    (lights(vectors="dome.lp"), cut(lp, -1), 0, f"{lp}:5: {whole}"),
    (places, cut("lit/places.txt", -1), 0, f"lit/places.txt:4: {whole}"),
    (places, cut("lit/eyes.txt", -2), 0, f"lit/eyes.txt:1: {whole}"),
    (lights(more="--names lit/names.txt"), cut("lit/names.txt", -1), 0, f"lit/names.txt:4: {whole}"),
    (lights(more="--intensities lit/intensities.txt"), cut("lit/intensities.txt", -1), 0, f"lit/intensities.txt:1: {whole}"),
    # Text of other editors.
    (colmap(), write("photos/mesh.obj", "\ufeffv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3\nf 1 3 4\n"), 0, "2 triangles", "4 vertices"),
    # Calibrations with a fault.
    (colmap(more="--skip-missing"), remove(photo), 0, "1 of the 3 images of", "are not there and are left out: "),
    (lights(vectors="dome.lp", more="--by-order"), renamed("lit/images/0.png", "lit/images/00.png"), 0, "whatever images it names"),
    (colmap(), write(images, "1 1 0 0 0 0 0 4 1 a b c.png\n2 1 0 0 0 0 0 4 1 d e f.png\n"), 2, f"{images}:2: expected the points X Y POINT3D_ID... of image 'a b c.png', or an empty line"),
    (colmap(), replace(images, r"^1 \S+", "1 5"), 2, "has a quaternion QW QX QY QZ of length ", "the others of 1: write its rotation again"),
]
