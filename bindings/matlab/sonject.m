function [injected, truth, masks] = sonject(pixels, scene, varargin)
%SONJECT  Puts simulated targets into a sonar image, by the command "sonject".
%   [INJECTED, TRUTH, MASKS] = SONJECT(PIXELS, SCENE) runs a scene.
%   [...] = SONJECT(PIXELS, SCENE, KEY, VALUE, ...) sets keys of the scene first.
%
%   PIXELS    a matrix with one row a ping, of class single or double, real or complex, or of
%             class int16, uint16 or uint8; or the name of an image file, TIFF, PNG or NumPy; or
%             [] if the scene says what to read.
%   SCENE     the name of a scene file, or a struct with the keys of scene files. File names
%             within a struct must be absolute.
%   KEY       a key such as 'objects[0].heading', with a VALUE: '60 deg', 1.5, {} or a struct.
%
%   INJECTED  the image with the targets: of the class of PIXELS, or of the file's samples.
%   TRUTH     truth.json as a struct. Its rows, columns and boxes count from 0.
%   MASKS     a struct of matrices as large as the image: labels (numbers of objects), highlight,
%             shadow and influence (each pixel that changed).
%
%   The environment's SONJECT_COMMAND names the command; by default it is "sonject" on the path.
%   If the command fails, its message becomes an error: sonject:scene for mistakes in scene or
%   image, sonject:failed for all else. Its notes become warnings. "sonject help KEY" in a shell
%   explains a key.
%
%   Example:
%      scene.sonar = struct('frequency', '100 kHz', 'bandwidth', '30 kHz', 'altitude', '10 m');
%      scene.input.geometry = struct('row_spacing', '5 cm', 'column_spacing', '5 cm', ...
%                                    'first_slant_range', '30 m');
%      scene.objects = {struct('shape', 'sphere', 'diameter', '0.5 m', 'material', 'steel')};
%      pixels = single(0.1 * abs(randn(128, 160) + 1i * randn(128, 160)));
%      [injected, truth, masks] = sonject(pixels, scene, 'injection.noise_floor', '-18 dB');
%      disp([truth.objects.target_strength_db, sum(masks.shadow(:))])

folder = tempname();
mkdir(folder);
remover = onCleanup(@() remove(folder));

if isstruct(scene)
    scene.sonject = 1; % the version of the keys
    text = jsonencode(scene); % JSON is YAML, too
    scene = fullfile(folder, 'scene.yaml');
    stream = fopen(scene, 'w', 'n', 'UTF-8');
    fprintf(stream, '%s', text);
    fclose(stream);
end
settings = varargin;
if isnumeric(pixels) && ~isempty(pixels)
    image_file = fullfile(folder, 'pixels.mat');
    save(image_file, 'pixels', '-v6');
    settings = [settings, {'input.path', image_file, 'input.array', 'pixels'}];
    if ~isreal(pixels)
        settings = [settings, {'input.complex', true}];
    end
elseif ~isempty(pixels)
    settings = [settings, {'input.path', pixels}];
end

result = fullfile(folder, 'result');
words = {'run', scene, '-o', result};
for i = 1:2:numel(settings)
    value = settings{i + 1};
    if ~ischar(value)
        value = jsonencode(value);
    end
    words = [words, {'--set', [settings{i}, '=', value]}]; %#ok<AGROW>
end
for note = regexp(command(words{:}), '(?<=note: )[^\r\n]*', 'match')
    warning('sonject:note', '%s', note{1});
end

if ~exist(fullfile(result, 'truth.json'), 'file')
    error('sonject:bands', 'the scene has bands: choose one by the key ''band''');
end
truth = jsondecode(fileread(fullfile(result, 'truth.json')));
injected = read_image(fullfile(result, truth.image), folder);
for name = {'labels', 'highlight', 'shadow', 'influence'}
    masks.(name{1}) = imread(fullfile(result, [name{1}, '.png']));
end
end

function array = read_image(file, folder)
[~, ~, kind] = fileparts(file);
if strcmp(kind, '.mat')
    array = load(file);
    array = array.pixels;
    return
elseif ~any(strcmp(kind, {'.tif', '.png', '.npy'}))
    error('sonject:format', 'the image is written as %s, which is not read here: run the command', kind);
end
% Octave's own reader of images rounds floats to 16 bits.
command('convert', file, fullfile(folder, 'image.npy'));
stream = fopen(fullfile(folder, 'image.npy'), 'r', 'ieee-le');
closer = onCleanup(@() fclose(stream));
head = fread(stream, 10, 'uint8');
text = fread(stream, [1, head(9) + 256 * head(10)], '*char');
sizes = sscanf(char(regexp(text, '\((.*?)\)', 'tokens', 'once')), '%d, ')';
type = char(regexp(text, '''descr'': ''.(\w+)''', 'tokens', 'once'));
if strcmp(type, 'c8')
    pairs = fread(stream, [2, prod(sizes)], '*single');
    array = complex(pairs(1, :), pairs(2, :));
else
    classes = struct('f4', 'single', 'u1', 'uint8', 'u2', 'uint16', 'i2', 'int16');
    array = fread(stream, prod(sizes), ['*', classes.(type)]);
end
array = reshape(array, sizes(2), sizes(1)).';
end

function output = command(varargin)
% Runs the command with these words and returns its messages.
program = getenv('SONJECT_COMMAND');
if isempty(program)
    program = 'sonject';
end
words = cellfun(@quote, [{program}, varargin], 'UniformOutput', false);
[status, output] = system([strjoin(words, ' '), ' 2>&1']);
output = strtrim(output);
if status == 3
    error('sonject:scene', '%s', output);
elseif status ~= 0
    error('sonject:failed', '%s (exit code %d)', output, status);
end
end

function word = quote(word)
% Quotes the word as one word of the shell.
if ispc()
    word = ['"', strrep(word, '"', '\"'), '"'];
else
    word = ['''', strrep(word, '''', '''\'''''), ''''];
end
end

function remove(folder)
if exist('confirm_recursive_rmdir', 'builtin') % Octave would ask
    confirm_recursive_rmdir(false, 'local');
end
rmdir(folder, 's');
end
