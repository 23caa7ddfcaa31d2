#!/bin/sh
# From photographs alone to a judged fit and a page: cameras by COLMAP, depths and mesh, import, tune, fit, judge, publish.
# A folder with an RTI light file (.lp) is imported with its lamps instead. docs/captures.md says how to photograph, and what
# each step checks.
# Usage: capture.sh [OPTIONS] PHOTOS OUT
#   --masks DIR      masks of the photographs, white = object (NAME.png, NAME.EXT.png, NAME_mask.png or mask_NAME.png);
#                    default: what the mesh covers
#   --mesh FILE      a surface in the frame of OUT/flat/points.ply, in place of one made from depths
#   --size PX        longest side of the photographs that are fitted, default 1600
#   --seconds S      about how long `radiafit tune` may take, default 300
#   --threads N      default: all cores
#   --camera MODEL   COLMAP's camera model, default SIMPLE_RADIAL; PINHOLE for photographs that are undistorted already
#   --go-on          go on where a step's outcome is poor
#   --until STEP     stop behind a step; steps: features matches cameras flat depths mesh masks dataset fit page
# Each step makes a folder OUT/STEP, whole or not at all, with its log in it; called again, the script goes on behind the
# last step that is done with the same options. Exit status: 0 done, 2 something to mend, as said.
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
radiafit=${RADIAFIT:-$root/build/release/src/app/radiafit}
export QT_QPA_PLATFORM=offscreen  # COLMAP asks for no display then

die() { printf '%s\n' "capture.sh: $1" >&2; exit 2; }

masks= mesh= size=1600 seconds=300 threads=0 camera=SIMPLE_RADIAL go_on= until=
while [ $# -gt 0 ]; do
    case $1 in
    --masks | --mesh | --size | --seconds | --threads | --camera | --until)
        [ $# -gt 1 ] || die "$1 takes a value: see the top of $0"
        eval "$(printf %s "${1#--}")=\$2"
        shift 2
        ;;
    --go-on) go_on=--go-on; shift ;;
    -h | --help) sed -n '2,/^set -eu/{/^#/s/^# \{0,1\}//p}' "$0"; exit 0 ;;
    -*) die "$1: no such option: see $0 --help" ;;
    *) break ;;
    esac
done
[ $# = 2 ] || die "give the folder of photographs and the folder to write: see $0 --help"
photos=$1 out=$2
for number in "$size" "$seconds" "$threads"; do
    case $number in '' | *[!0-9]*) die "'$number': --size, --seconds and --threads take whole numbers" ;; esac
done
case " features matches cameras flat depths mesh masks dataset fit page " in
*" ${until:-page} "*) ;;
*) die "--until $until: choose features, matches, cameras, flat, depths, mesh, masks, dataset, fit or page" ;;
esac
[ -d "$photos" ] || die "$photos: no such folder of photographs"
[ -z "$masks" ] || [ -d "$masks" ] || die "$masks: no such folder of masks"
[ -z "$mesh" ] || [ -f "$mesh" ] || die "$mesh: no such mesh"
[ -x "$radiafit" ] || die "$radiafit is missing: run make build"
photos=$(cd "$photos" && pwd)
[ -z "$masks" ] || masks=$(cd "$masks" && pwd)
mkdir -p "$out"
out=$(cd "$out" && pwd)
case $out/ in "$photos"/*) die "$out: inside the folder of photographs: write elsewhere" ;; esac
count=$(find "$photos/" -maxdepth 1 -type f,l | grep -icE '\.(jpe?g|png|tiff?|bmp|exr|pfm|hdr)$') || true
[ "$count" -ge 3 ] || die "$photos: $count photographs here, fewer than three: give JPEG, PNG or TIFF files"
[ "$threads" != 0 ] && of_colmap=$threads || of_colmap=-1
of_radiafit="--threads $threads"
lights=$(find "$photos/" -maxdepth 1 -type f,l -iname '*.lp' | sort)
case $lights in *"
"*) die "$photos: several light files (.lp): keep the one that belongs to these images" ;; esac

# What each step takes on two cores of 2020, in seconds; learnt anew from the steps that were done.
cost() {
    case $1 in
    features) echo $((count)) ;;
    matches) echo $((1 + count * (count - 1) / 4)) ;;
    cameras) echo $((10 + count * 2)) ;;
    flat) echo $((1 + count / 4)) ;;
    depths) echo $((10 + count * 8)) ;;
    mesh) echo $((60 + count)) ;;
    masks) echo 2 ;;
    dataset) echo $((10 + count)) ;;
    fit) echo $((seconds + 60)) ;;
    page) echo 20 ;;
    esac
}
clock() { printf '%d:%02d' $(($1 / 60)) $(($1 % 60)); }

steps="features matches cameras flat depths mesh masks dataset fit page"
[ -z "$lights" ] || steps="dataset fit page"
total=$(echo $steps | wc -w) number=0 redo= began=$(date +%s) done_cost=0
child=
stop() { [ -z "$child" ] || kill "$child" 2>/dev/null || true; exit 130; }
trap stop INT TERM HUP

left() {  # seconds that this step and those behind it will take
    all=0 here=
    for s in $steps; do
        [ "$s" != "$1" ] || here=yes
        [ -z "$here" ] || all=$((all + $(cost "$s")))
    done
    spent=$(($(date +%s) - began))
    [ $done_cost -lt 10 ] || all=$((all * spent / done_cost))
    echo $all
}

# run COMMAND...: it writes to the step's log; its last line is shown whenever ten seconds have brought another one.
run() {
    "$@" >>"$part/log" 2>&1 </dev/null &
    child=$! shown= ticks=0
    while kill -0 "$child" 2>/dev/null; do
        sleep 0.2
        ticks=$(((ticks + 1) % 50))
        [ $ticks = 0 ] || continue
        line=$(tail -n 1 "$part/log" | cut -c1-120)
        [ "$line" = "$shown" ] || [ -z "$line" ] || printf '      %s\n' "$line" >&2
        shown=$line
    done
    status=0
    wait "$child" || status=$?
    child=
    return $status
}

# step NAME TITLE OPTIONS FUNCTION CURE: makes OUT/NAME unless it is there already, made with the same options, and so are
# all before it. The function writes to $part.
step() {
    name=$1
    number=$((number + 1))
    if [ -z "$redo" ] && [ "$(cat "$out/$name/step" 2>/dev/null)" = "$3" ]; then
        echo "[$number/$total] $2: done before" >&2
    else
        redo=yes part=$out/$name.part
        rm -rf "${out:?}/$name" "$part"
        mkdir "$part"
        echo "[$number/$total] $2; about $(clock "$(left "$name")") left in all" >&2
        step_began=$(date +%s)
        if ! $4; then
            tail -n 3 "$part/log" >&2
            die "$2 failed (all it said: $part/log): $5"
        fi
        took=$(($(date +%s) - step_began))
        done_cost=$((done_cost + $(cost "$name")))
        # Wall-clock and processor time of this step, in seconds.
        measure_processor
        printf '%s %s %s\n' "$name" "$took" "$processor" >"$part/seconds"
        printf '%s' "$3" >"$part/step"
        mv "$part" "$out/$name"
        echo "      done in $(clock $took)" >&2
        [ ! -s "$out/$name/said" ] || sed 's/^/      /' "$out/$name/said" >&2
    fi
    [ "$until" != "$name" ] || exit 0
}
last_processor=0
measure_processor() {  # of all children, since the last call; not in a subshell, which has none
    times >"$part/times"
    now=$(awk -F'[ms ]+' 'NR == 2 { printf "%d", 60 * $1 + $2 + 60 * $3 + $4 }' "$part/times")
    rm -f "$part/times"
    processor=$((now - last_processor)) last_processor=$now
}

features() {
    run colmap feature_extractor --database_path "$part/database.db" --image_path "$photos" \
        --ImageReader.single_camera 1 --ImageReader.camera_model "$camera" \
        --SiftExtraction.use_gpu 0 --SiftExtraction.num_threads "$of_colmap"
}
matches() {
    cp "$out/features/database.db" "$part/database.db" &&
        run colmap exhaustive_matcher --database_path "$part/database.db" --SiftMatching.use_gpu 0 \
            --SiftMatching.num_threads "$of_colmap"
}
cameras() {
    cp "$out/matches/database.db" "$part/database.db" && mkdir "$part/models" &&
        run colmap mapper --database_path "$part/database.db" --image_path "$photos" --output_path "$part/models" \
            --Mapper.num_threads "$of_colmap" &&
        largest=$(find "$part/models" -name images.bin -size +0 -exec ls -S {} + | head -n 1) && [ -n "$largest" ] &&
        mv "${largest%/images.bin}" "$part/model" && rm -rf "$part/models" "$part/database.db"
}
undistort() {  # FROM SIDE TO
    run colmap image_undistorter --image_path "$1" --input_path "$out/cameras/model" --output_path "$3" \
        --max_image_size "$2"
}
flat() {
    # Small photographs for depths, larger ones for the fit; both in one frame.
    undistort "$photos" 800 "$part/small" && rm -rf "$part/small/stereo" && undistort "$photos" "$size" "$part/large" &&
        run colmap model_converter --input_path "$out/cameras/model" --output_path "$part/points.ply" --output_type PLY &&
        { [ -z "$masks" ] || undistort_masks; } &&
        "$radiafit" capture check-model "$part/large/sparse" --images "$photos" $go_on >"$part/said" 2>>"$part/log"
}
undistort_masks() {
    # COLMAP takes the mask for the photograph of its name; import reads what comes out as a mask of that name.
    mkdir "$part/as-given" "$part/masks-small" "$part/masks" || return 1
    for photo in "$photos"/*; do
        base=${photo##*/} stem=${photo##*/}
        stem=${stem%.*}
        for mask in "$stem.png" "$base.png" "${stem}_mask.png" "mask_$stem.png"; do
            [ ! -f "$masks/$mask" ] || { ln -sf "$masks/$mask" "$part/as-given/$base"; break; }
        done
    done
    for kind in small large; do
        [ $kind = small ] && side=800 to=$part/masks-small || { side=$size to=$part/masks; }
        undistort "$part/as-given" $side "$part/undistorted" || return 1
        for file in "$part"/undistorted/images/*; do mv "$file" "$to/${file##*/}.png"; done
        rm -rf "$part/undistorted"
    done
}
depths() {
    run "$radiafit" $of_radiafit capture depths --model "$out/flat/small/sparse" --images "$out/flat/small/images" \
        -o "$part/stereo" && tail -n 1 "$part/log" >"$part/said"
}
small_masks() { [ -z "$masks" ] || echo "--images $out/flat/small/images --masks $out/flat/masks-small"; }
make_mesh() {
    if [ -n "$mesh" ]; then
        cp "$mesh" "$part/mesh.${mesh##*.}" && checked=$part/mesh.${mesh##*.}
    else
        mkdir "$part/workspace" && ln -s "$out/flat/small/images" "$out/flat/small/sparse" "$out/depths/stereo" "$part/workspace" &&
            run colmap stereo_fusion --workspace_path "$part/workspace" --output_path "$part/points.ply" \
                --StereoFusion.min_num_pixels 3 --StereoFusion.max_normal_error 25 \
                --StereoFusion.num_threads "$of_colmap" &&
            run colmap poisson_mesher --input_path "$part/points.ply" --output_path "$part/whole.ply" \
                --PoissonMeshing.depth 9 --PoissonMeshing.trim 6 --PoissonMeshing.num_threads "$of_colmap" &&
            run "$radiafit" $of_radiafit capture cut-mesh "$part/whole.ply" --model "$out/flat/small/sparse" \
                --depths "$out/depths/stereo" $(small_masks) -o "$part/mesh.ply" && rm -r "$part/workspace" || return 1
        checked=$part/mesh.ply
    fi
    "$radiafit" $of_radiafit capture check-mesh "$checked" --model "$out/flat/small/sparse" $(small_masks) $go_on \
        >"$part/said" 2>>"$part/log"
}
made_mesh() { find "$out/mesh" -maxdepth 1 -name 'mesh.*' | head -n 1; }
make_masks() {
    if [ -n "$masks" ]; then
        ln -s ../flat/masks "$part/masks"
    else
        run "$radiafit" $of_radiafit capture masks "$(made_mesh)" --model "$out/flat/large/sparse" -o "$part/masks"
    fi
}
dataset() {
    run "$radiafit" $of_radiafit import colmap --model "$out/flat/large/sparse" --images "$out/flat/large/images" \
        --masks "$out/masks/masks" --mesh "$(made_mesh)" --gains estimate --name "${photos##*/}" -o "$part/dataset"
}
lit_dataset() {
    run "$radiafit" $of_radiafit import lights --images "$photos" --lights "$lights" --max-size "$size" \
        --name "${photos##*/}" -o "$part/dataset"
}
fit() {
    run env RADIAFIT="$radiafit" "$root/datasets/scripts/tune_and_fit.sh" "$out/dataset/dataset" "$part/fit" "$seconds" &&
        sed -n '/(test): /p' "$part/log" >"$part/said"
}
page() {
    if "$radiafit" publish --help >/dev/null 2>&1; then
        run "$radiafit" publish "$out/fit/fit" -o "$part/page"
    else
        run "$radiafit" render "$out/fit/fit" --all held-out -o "$part/page"
    fi
}

overlap="take more photographs between neighbours (10 to 15 degrees apart), sharp, the object still, something structured around it"
if [ -z "$lights" ]; then
    sh "$root/scripts/install-packages.sh" capture
    command -v colmap >/dev/null || die "colmap is missing: install Debian's package colmap"
    listed=$(cd "$photos" && find . -maxdepth 1 -type f,l | sort | cksum)
    step features "features of $count photographs" "$listed $camera" features "give JPEG, PNG or TIFF photographs that COLMAP can read"
    step matches "matches between photographs" "" matches "free some memory, or give --threads 1"
    step cameras "cameras" "" cameras "no two photographs fit together: $overlap"
    step flat "undistorted photographs" "$size $masks $go_on" flat "mend what it says, or give --go-on"
    if [ -z "$mesh" ]; then
        step depths "depths" "" depths "mend what it says"
        step mesh "mesh" "$go_on" make_mesh "mend what it says, give --go-on, or a mesh of your own in the frame of $out/flat/points.ply with --mesh"
    else
        total=$((total - 1))
        step mesh "mesh" "$mesh $go_on" make_mesh "bring the mesh into the frame of $out/flat/points.ply"
    fi
    step masks "masks" "" make_masks "mend what it says"
    step dataset "import" "" dataset "mend what it says"
else
    step dataset "import" "$lights $size" lit_dataset "mend what it says"
fi
step fit "tune, fit and judge" "$seconds" fit "mend what it says"
step page "page" "" page "mend what it says"
echo "the score, on photographs that were held out:" >&2
cat "$out/fit/said"
echo "the page: $out/page/page; the fit: $out/fit/fit; seconds by step and processor seconds: $out/*/seconds" >&2
