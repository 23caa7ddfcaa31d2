#!/bin/sh
# From photographs alone to a judged fit and a page: cameras by COLMAP, depths, mesh, masks, import, tune, fit, judge, publish.
# A folder with an RTI light file (.lp) is imported with its lamps instead, also one of Cultural Heritage Imaging's, which has
# that file in assembly-files and the images in jpeg-exports; with --spheres, lamps are found by glossy spheres in the photographs
# (docs/rti.md). docs/captures.md says how to photograph, and what each step checks.
# Usage: capture.sh [OPTIONS] PHOTOS OUT
#   --masks DIR      masks of the photographs, white = object (NAME.png, NAME.EXT.png, NAME_mask.png or mask_NAME.png);
#                    default: what the mesh covers
#   --mesh FILE      a surface in the frame of OUT/flat/points.ply, in place of one made from depths
#   --spheres WHICH  the photographs show one surface pixel on pixel, under a lamp each, and glossy spheres that mirror it:
#                    auto, auto:N or a file of circles, as `radiafit import lights` takes; no light file is read then
#   --ground WHAT    the plane that the object stands on: cut (default; with --masks keep), keep, or disc: a disc of it around
#                    the object. Not of --mesh, which stays as it is
#   --title TEXT, --caption TEXT, --credit TEXT, --licence TEXT   on the page, as `radiafit publish` takes them
#   --size PX        longest side of the photographs that are fitted, default 1600
#   --seconds S      about how long `radiafit tune` may take, default 300
#   --threads N      default: all cores
#   --camera MODEL   COLMAP's camera model, default SIMPLE_RADIAL; PINHOLE for photographs that are undistorted already
#   --go-on          go on where a step's outcome is poor
#   --replace        make steps anew that are there already, of other options or photographs, and all behind them
#   --until STEP     stop behind a step; steps: features matches cameras flat depths mesh masks dataset tune fit page
# Each step makes a folder OUT/STEP, whole or not at all, with its log in it; called again, the script goes on behind the
# last step that is done with the same options, and depths and fit where they were stopped; with other options, a step that
# is done stays, and is named, but for --replace. OUT/page/index.html is the page, OUT/fit/fit the fit. Exit status: 0 done,
# 2 something to correct, as said.
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
radiafit=${RADIAFIT:-$root/build/release/bin/radiafit}
export QT_QPA_PLATFORM=offscreen  # COLMAP asks for no display then

die() { printf '%s\n' "capture.sh: $1" >&2; exit 2; }

masks="" mesh="" spheres="" ground="" title="" caption="" credit="" licence="" size=1600 seconds=300 threads=0 camera=SIMPLE_RADIAL go_on="" replace="" until=""
while [ $# -gt 0 ]; do
    case $1 in
    --masks | --mesh | --spheres | --ground | --title | --caption | --credit | --licence | --size | --seconds | --threads | --camera | --until)
        [ $# -gt 1 ] || die "$1 takes a value: see the top of $0"
        eval "$(printf %s "${1#--}")=\$2"
        shift 2
        ;;
    --go-on) go_on=--go-on; shift ;;
    --replace) replace=yes; shift ;;
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
case " features matches cameras flat depths mesh masks dataset tune fit page " in
*" ${until:-page} "*) ;;
*) die "--until $until: choose features, matches, cameras, flat, depths, mesh, masks, dataset, tune, fit or page" ;;
esac
[ -n "$ground" ] || if [ -n "$masks" ]; then ground=keep; else ground=cut; fi
case $ground in cut | keep | disc) ;; *) die "--ground $ground: choose cut, keep or disc" ;; esac
[ -d "$photos" ] || die "$photos: no such folder of photographs"
[ -z "$masks" ] || [ -d "$masks" ] || die "$masks: no such folder of masks"
[ -z "$mesh" ] || [ -f "$mesh" ] || die "$mesh: no such mesh"
case $spheres in
"" | auto | auto:*) ;;
*)
    [ -f "$spheres" ] || die "$spheres: no such file of circles: give --spheres auto, or x y radius of each sphere in it"
    spheres=$(cd "$(dirname "$spheres")" && pwd)/$(basename "$spheres")
    ;;
esac
[ -x "$radiafit" ] || die "$radiafit is missing: run make build"
photos=$(cd "$photos" && pwd)
[ -z "$masks" ] || masks=$(cd "$masks" && pwd)
[ -z "$mesh" ] || mesh=$(cd "$(dirname "$mesh")" && pwd)/$(basename "$mesh")
named=${photos##*/}
light_files() { find "$1/" -maxdepth 1 -type f,l -iname '*.lp' ! -name '.*' | sort; }
where=$photos lights=""
[ -n "$spheres" ] || lights=$(light_files "$photos")
if [ -z "$lights$spheres" ] && [ -d "$photos/assembly-files" ] && [ -d "$photos/jpeg-exports" ]; then
    where=$photos/assembly-files
    lights=$(light_files "$where")
    [ -n "$lights" ] || die "$where: no light file (.lp) here: make one with RTIBuilder or relight"
    photos=$photos/jpeg-exports
    [ -n "$(ls "$photos")" ] || die "$photos: no photographs here, which $lights names: copy them into it"
fi
case $lights in *"
"*) die "$where: several light files (.lp): keep the one that belongs to these images" ;; esac
endings="png jpg jpeg tif tiff"  # those that src/core/image/image_format.cpp has for COLMAP; tests/capture/image_file_test.cpp compares
photographs() { find "$1/" -maxdepth 1 -type f,l ! -name '.*' | grep -iE "\.($(echo "$endings" | tr ' ' '|'))\$"; }
count=$(photographs "$photos" | wc -l)
if [ -z "$lights" ] && [ "$count" -lt 3 ]; then
    for folder in "$photos"/*/; do
        [ -d "$folder" ] || continue
        inside=$(photographs "${folder%/}" | wc -l)
        [ "$inside" -lt 3 ] || die "$photos: $count photographs here, but $inside in ${folder%/}: give that folder"
    done
    die "$photos: $count photographs here, fewer than three: give JPEG, PNG or TIFF files"
fi
mkdir -p "$out" || die "$out: cannot make this folder: write elsewhere"
out=$(cd "$out" && pwd)
case $out/ in "$photos"/*)
    rmdir "$out" 2>/dev/null || true
    die "$out: inside the folder of photographs: write elsewhere"
    ;;
esac
exec 9>"$out/lock"
flock -n 9 || die "$out: another run writes here: wait for it, or write elsewhere"
[ "$threads" != 0 ] && of_colmap=$threads || of_colmap=-1
of_radiafit="--threads $threads"

# What each step is expected to take (time_left.awk's KIND and EXPECTED), as 40 photographs of 800 pixels a side took. COLMAP compares
# every two photographs.
cost() {
    case $1 in
    features) echo all $((1 + count * 5 / 3)) ;;
    matches) echo all $((1 + count * (count - 1) * 5 / 8)) ;;
    cameras) echo one $((5 + count * 3 / 8)) ;;
    flat) echo all $((1 + count / 4)) ;;
    depths) echo all $((10 + count * 14)) ;;
    mesh) echo all $((20 + count / 4)) ;;
    masks) echo all 2 ;;
    dataset) echo all $((8 + count)) ;;
    tune) echo clock "$seconds" ;;
    fit) echo all $((20 + seconds * 2 / 3)) ;;
    page) echo all 60 ;;
    esac
}
# Of a file or a folder's files: another one where any was changed.
stamp() { find -L "$1" -maxdepth 1 -type f -printf '%P %s %T@\n' | sort | cksum; }
clock() { printf '%d:%02d' $(($1 / 60)) $(($1 % 60)); }

steps="features matches cameras flat depths mesh masks dataset tune fit page"
[ -z "$mesh" ] || steps="features matches cameras flat mesh masks dataset tune fit page"
[ -z "$lights$spheres" ] || steps="dataset tune fit page"
total=$(echo $steps | wc -w) number=0 redo=""
[ "$threads" != 0 ] && cores=$threads || cores=$(nproc)
ticks_per_second=$(getconf CLK_TCK)
child=
stop() {
    if [ -n "$child" ]; then
        kill "$child" 2>/dev/null || true
        wait "$child" || true  # it keeps what it has finished
    fi
    echo "capture.sh: stopped; the same command goes on from here" >&2
    exit 130
}
trap stop INT TERM HUP

# time_left STEP WALL PROCESSOR: seconds that this step, which took so many so far, and those behind it will take.
time_left() {
    state=done
    for s in $steps; do
        took_so_far=""
        if [ "$s" = "$1" ]; then
            state=now took_so_far="$2 $3"
        elif [ $state = now ]; then
            state=coming
        fi
        [ $state != done ] || took_so_far=$(cut -d' ' -f2- "$out/$s/seconds")
        echo "$state $(cost "$s") $took_so_far"
    done | awk -f "$root/datasets/scripts/time_left.awk" -v cores="$cores"
}
last_processor=0
measure_processor() {  # used: seconds of this step, also of a program that runs; not in a subshell, which has no children
    times >"$part/times"
    ended=$(awk -F'[ms ]+' 'NR == 2 { printf "%d", 60 * $1 + $2 + 60 * $3 + $4 }' "$part/times")
    rm -f "$part/times"
    running=""
    [ -z "$child" ] || running=$(sed 's/.*) //' "/proc/$child/stat" 2>/dev/null |
        awk -v ticks="$ticks_per_second" '{ printf "%d", ($12 + $13 + $14 + $15) / ticks }') || true
    used=$((ended - last_processor + ${running:-0}))
}

# run COMMAND...: it writes to the step's log; every ten seconds the time left and its last line are shown.
run() { run_into "$part/log" "$@"; }
# run_into FILE COMMAND...: its standard output goes to the file.
run_into() {
    into=$1
    shift
    "$@" >>"$into" 2>>"$part/log" </dev/null &
    child=$! ticks=0
    while kill -0 "$child" 2>/dev/null; do
        sleep 0.2
        ticks=$(((ticks + 1) % 50))
        [ $ticks = 0 ] || continue
        line=$(tail -n 1 "$part/log" | tr '\r\t' '  ' | sed 's/^ *//' | cut -c1-100)
        measure_processor
        printf '      %s left: %s\n' "$(clock "$(time_left "$name" $(($(date +%s) - step_began)) "$used")")" "$line" >&2
    done
    status=0
    wait "$child" || status=$?
    child=
    return $status
}

# step NAME TITLE OPTIONS FUNCTION CURE: makes OUT/NAME unless it is there already, made with the same options, and so are
# all before it: then with --replace alone, as are steps behind it that are done. The function writes to $part. What a run that was stopped left there stays for depths and fit, which go on
# from it.
step() {
    name=$1
    number=$((number + 1))
    if [ -z "$redo" ] && [ -d "$out/$name" ] && [ "$(cat "$out/$name/step")" = "$3" ]; then
        echo "[$number/$total] $2: done before" >&2
    else
        [ -n "$redo$replace" ] || nothing_done_from "$name"
        part=$out/$name.part
        case $name in depths | fit) ;; *) redo=yes ;; esac
        if [ -n "$redo" ] || [ "$(cat "$part/step" 2>/dev/null)" != "$3" ]; then rm -rf "$part"; fi
        redo=yes
        rm -rf "${out:?}/$name"
        mkdir -p "$part"
        printf '%s' "$3" >"$part/step"
        touch "$part/log"
        echo "[$number/$total] $2; about $(clock "$(time_left "$name" 0 0)") left in all" >&2
        step_began=$(date +%s)
        if ! $4; then
            tail -n 3 "$part/log" >&2
            die "$2 failed (all it said: $part/log): $5"
        fi
        took=$(($(date +%s) - step_began))
        # Wall-clock and processor time of this step, in seconds.
        measure_processor
        printf '%s %s %s\n' "$name" "$took" "$used" >"$part/seconds"
        last_processor=$((last_processor + used))
        mv "$part" "$out/$name"
        echo "      done in $(clock $took)" >&2
        [ ! -s "$out/$name/said" ] || sed 's/^/      /' "$out/$name/said" >&2
    fi
    [ "$until" != "$name" ] || exit 0
}
# Dies where this step, or one behind it, is done.
nothing_done_from() {
    here=""
    for s in $steps; do
        [ "$s" != "$1" ] || here=yes
        [ -z "$here" ] || [ ! -d "$out/$s" ] ||
            die "$out/$s: is there already, made with other options or of other photographs; --replace puts this one in its place, or write elsewhere"
    done
}

features() {
    run colmap feature_extractor --database_path "$part/database.db" --image_path "$photos" \
        --ImageReader.single_camera 1 --ImageReader.camera_model "$camera" \
        --SiftExtraction.use_gpu 0 --SiftExtraction.num_threads "$of_colmap" || return 1
    # COLMAP goes on where it cannot take a photograph, such as one of another size.
    sed -n 's/^ *Features: *//p' "$part/log" | sort -n >"$part/counts"
    taken=$(wc -l <"$part/counts")
    median=$(sed -n "$(((taken + 1) / 2))p" "$part/counts")
    echo "$taken of $count photographs read; ${median:-0} features in the median" >"$part/said"
    grep 'ERROR' "$part/log" | sort | uniq -c | sed 's/^ *\([0-9]*\) */\1 times COLMAP said: /' >>"$part/said" || true
    if [ "$taken" -lt 3 ]; then
        echo "fewer than three photographs could be read: they need one size and one zoom" >>"$part/log"
        return 1
    fi
    if [ "${median:-0}" -lt 500 ] && [ -z "$go_on" ]; then
        echo "${median:-0} features are too few: photograph sharper, or put something patterned around the object; --go-on goes on" >>"$part/log"
        return 1
    fi
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
        "$radiafit" capture check-model "$part/large/sparse" --images "$photos" $go_on >"$part/said" 2>>"$part/log" &&
        preview "$part/small" "calibrated points"
}
preview() {  # WORKSPACE WHAT [OPTIONS]: a picture of three photographs above what is known by now
    workspace=$1 what=$2
    shift 2
    if run "$radiafit" $of_radiafit capture preview --model "$workspace/sparse" --images "$workspace/images" "$@" -o "$part/preview.png"; then
        echo "a picture of three photographs and the $what: $out/$name/preview.png" >>"$part/said"
    else
        echo "no picture of the $what could be made: $out/$name/log says why" >>"$part/said"
    fi
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
    if [ ! -d "$part/stereo" ]; then  # what a run that was stopped had finished
        run "$radiafit" $of_radiafit capture depths --model "$out/flat/small/sparse" --images "$out/flat/small/images" \
            -o "$part/stereo" || return 1
    fi
    tail -n 1 "$part/log" >"$part/said"
}
with_masks() {  # COMMAND... with those masks that were given
    if [ -n "$masks" ]; then
        "$@" --images "$out/flat/small/images" --masks "$out/flat/masks-small"
    else
        "$@"
    fi
}
make_mesh() {
    if [ -n "$mesh" ]; then
        cp "$mesh" "$part/mesh.${mesh##*.}" && checked=$part/mesh.${mesh##*.}
    else
        mkdir "$part/workspace" && ln -s "$out/flat/small/images" "$out/flat/small/sparse" "$out/depths/stereo" "$part/workspace" &&
            run colmap stereo_fusion --workspace_path "$part/workspace" --output_path "$part/points.ply" \
                --StereoFusion.min_num_pixels 3 --StereoFusion.max_normal_error 25 \
                --StereoFusion.num_threads "$of_colmap" &&
            run colmap poisson_mesher --input_path "$part/points.ply" --output_path "$part/whole.ply" \
                --PoissonMeshing.depth 8 --PoissonMeshing.trim 6 --PoissonMeshing.num_threads "$of_colmap" &&
            with_masks run "$radiafit" $of_radiafit capture cut-mesh "$part/whole.ply" --model "$out/flat/small/sparse" \
                --depths "$out/depths/stereo" --ground "$ground" -o "$part/mesh.ply" && rm -r "$part/workspace" || return 1
        checked=$part/mesh.ply
    fi
    set -- --model "$out/flat/small/sparse" $go_on
    [ -n "$mesh" ] || set -- "$@" --depths "$out/depths/stereo"
    with_masks run_into "$part/said" "$radiafit" $of_radiafit capture check-mesh "$checked" "$@" &&
        preview "$out/flat/small" mesh --mesh "$checked"
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
        --masks "$out/masks/masks" --mesh "$(made_mesh)" --name "$named" -o "$part/dataset"
}
lit_dataset() {
    if [ -n "$spheres" ]; then set -- --spheres "$spheres"; else set -- --lights "$lights"; fi
    run "$radiafit" $of_radiafit import lights --images "$photos" "$@" --max-size "$size" \
        --name "$named" -o "$part/dataset" || return 1
    [ -z "$spheres" ] || grep -E '^(warning: |[0-9]+ spheres?, |[a-z]+ of [0-9]+ lamps )' "$part/log" >"$part/said" || true
}
tune() {
    run_into "$part/table" "$radiafit" $of_radiafit tune "$out/dataset/dataset" --seconds "$seconds" &&
        # Its last line: radiafit fit DATASET OPTIONS -o DATASET-tuned
        options=$(tail -n 1 "$part/table") && options=${options#"radiafit fit $out/dataset/dataset "} &&
        printf '%s\n' "${options%" -o $out/dataset/dataset-tuned"}" >"$part/options" && cp "$part/options" "$part/said"
}
fit() {
    options=$(cat "$out/tune/options")
    # shellcheck disable=SC2086  # options are words
    run "$radiafit" $of_radiafit fit "$out/dataset/dataset" $options -o "$part/fit" &&
        run_into "$part/score" "$radiafit" $of_radiafit judge "$part/fit" && grep '(test): ' "$part/score" >"$part/said"
}
publish() {
    run "$radiafit" $of_radiafit publish "$out/fit/fit" --single-file ${title:+--title "$title"} ${caption:+--caption "$caption"} \
        ${credit:+--credit "$credit"} ${licence:+--licence "$licence"} "$@" -o "$part/index.html"
}
page() {
    publish && return
    # A surface of many texels needs more than publish's default; it has said how much.
    megabytes=$(sed -n 's/.*the page would have \([0-9]*\)\.[0-9] MB.*/\1/p' "$part/log")
    [ -n "$megabytes" ] && publish --megabytes $((megabytes + 1))
}

overlap="take more photographs between neighbours (10 to 15 degrees apart), sharp, the object still, something structured around it"
if [ -z "$lights$spheres" ]; then
    sh "$root/scripts/install-packages.sh" capture
    command -v colmap >/dev/null || die "colmap is missing: install Debian's package colmap"
    step features "features of $count photographs" "$(stamp "$photos") $camera" features "give JPEG, PNG or TIFF photographs that COLMAP can read"
    step matches "matches between photographs" "" matches "free some memory, or give --threads 1"
    step cameras "cameras" "" cameras "no two photographs fit together: $overlap"
    step flat "undistorted photographs" "$size $masks $([ -z "$masks" ] || stamp "$masks")" flat "correct what it says, or give --go-on"
    if [ -z "$mesh" ]; then
        step depths "depths" "" depths "correct what it says"
        step mesh "mesh" "$ground" make_mesh "correct what it says, give --go-on, or a mesh of your own in the frame of $out/flat/points.ply with --mesh"
    else
        step mesh "mesh" "$mesh $(stamp "$mesh")" make_mesh "bring the mesh into the frame of $out/flat/points.ply"
    fi
    step masks "masks" "" make_masks "correct what it says"
    step dataset "import" "" dataset "correct what it says"
else
    step dataset "import" "$lights$spheres $([ ! -f "$spheres" ] || stamp "$spheres")$(stamp "$photos") $size" lit_dataset "correct what it says"
fi
step tune "which model and options suit these photographs" "$seconds" tune "correct what it says"
step fit "fit and judge" "" fit "correct what it says"
step page "page" "${title:+title=$title }${caption:+caption=$caption }${credit:+credit=$credit }${licence:+licence=$licence }" page "correct what it says"
echo "the score, on photographs that were held out:" >&2
cat "$out/fit/said"
echo "the page: $out/page/index.html; the fit: $out/fit/fit; seconds by step, and processor seconds: $out/*/seconds" >&2
